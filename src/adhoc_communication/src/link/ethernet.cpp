#include "link/ethernet.hpp"

#include <algorithm>

namespace adhoc_communication {

EthernetHeader ethernet_header(const Frame& frame) {
  EthernetHeader header;
  auto end = std::copy(frame.destination.begin(), frame.destination.end(), header.begin());
  end = std::copy(frame.source.begin(), frame.source.end(), end);
  *end++ = kEthertype >> 8;
  *end = kEthertype & 0xff;
  return header;
}

Bytes to_wire(const Frame& frame) {
  const EthernetHeader header = ethernet_header(frame);
  Bytes octets(header.size() + frame.bytes.size());
  std::copy(frame.bytes.begin(), frame.bytes.end(), std::copy(header.begin(), header.end(), octets.begin()));
  return octets;
}

bool from_wire(const std::uint8_t* octets, std::size_t size, Frame& frame) {
  if (size < kEthernetHeaderSize) return false;
  if ((octets[12] << 8 | octets[13]) != kEthertype) return false;
  std::copy_n(octets, frame.destination.size(), frame.destination.begin());
  std::copy_n(octets + frame.destination.size(), frame.source.size(), frame.source.begin());
  frame.bytes.assign(octets + kEthernetHeaderSize, octets + size);
  return true;
}

std::optional<Frame> from_wire(const std::uint8_t* octets, std::size_t size) {
  Frame frame;
  if (!from_wire(octets, size, frame)) return std::nullopt;
  return frame;
}

}  // namespace adhoc_communication
