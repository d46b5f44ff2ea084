#include "link/ethernet.hpp"

#include <algorithm>

namespace adhoc_communication {

Bytes to_wire(const Frame& frame) {
  Bytes octets;
  octets.reserve(kEthernetHeaderSize + frame.bytes.size());
  octets.insert(octets.end(), frame.destination.begin(), frame.destination.end());
  octets.insert(octets.end(), frame.source.begin(), frame.source.end());
  octets.push_back(kEthertype >> 8);
  octets.push_back(kEthertype & 0xff);
  octets.insert(octets.end(), frame.bytes.begin(), frame.bytes.end());
  return octets;
}

std::optional<Frame> from_wire(const std::uint8_t* octets, std::size_t size) {
  if (size < kEthernetHeaderSize) return std::nullopt;
  if ((octets[12] << 8 | octets[13]) != kEthertype) return std::nullopt;
  Frame frame;
  std::copy_n(octets, frame.destination.size(), frame.destination.begin());
  std::copy_n(octets + frame.destination.size(), frame.source.size(), frame.source.begin());
  frame.bytes.assign(octets + kEthernetHeaderSize, octets + size);
  return frame;
}

}  // namespace adhoc_communication
