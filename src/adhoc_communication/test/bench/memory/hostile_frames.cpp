#include "hostile_frames.hpp"

#include "crowd.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::bench {

void HostileFrames::listen(const std::deque<Frame>& frames) {
  for (const Frame& frame : frames) {
    if (heard_.size() == kMostHeard) heard_.erase(heard_.begin() + static_cast<std::ptrdiff_t>(kMostHeard / 2));
    heard_.push_back(frame);
  }
}

Frame HostileFrames::next() {
  switch (count_++ % 5) {
    case 0:
      return garbage();
    case 1:
      return plausible();
    case 2:
      return altered();
    case 3:
      return heard();
    default:
      return in_other_name();
  }
}

Bytes HostileFrames::octets(std::size_t most) {
  Bytes octets(random_.next() % (most + 1));
  for (std::uint8_t& octet : octets) octet = static_cast<std::uint8_t>(random_.next());
  return octets;
}

MacAddress HostileFrames::anybody() {
  MacAddress address{2};
  for (std::size_t i = 1; i < address.size(); ++i) address[i] = static_cast<std::uint8_t>(random_.next());
  return address;
}

Frame HostileFrames::garbage() { return {Crowd::middle(), anybody(), octets(1500)}; }

Frame HostileFrames::plausible() {
  wire::FrameHeader header;
  header.type = static_cast<wire::FrameType>(1 + random_.next() % 13);
  header.flags = static_cast<std::uint8_t>((random_.next() % 4) << 1 | (sealed_ ? wire::kSealed : 0));
  header.sender = random_.next() % 2 == 0 ? anybody() : Crowd::address(random_.next() % Crowd::kNeighbors);
  for (std::uint8_t& octet : header.boot_id) octet = static_cast<std::uint8_t>(random_.next());
  header.counter = random_.next() >> random_.next() % 64;
  header.next_hop = random_.next() % 2 == 0 ? Crowd::middle() : wire::kEverybody;
  header.link_sequence = static_cast<std::uint32_t>(random_.next());
  return {header.next_hop, header.sender, wire::close_openly(header, octets(1400))};
}

Frame HostileFrames::altered() {
  Frame frame = heard();
  frame.bytes[random_.next() % frame.bytes.size()] ^= static_cast<std::uint8_t>(1 + random_.next() % 255);
  return frame;
}

Frame HostileFrames::in_other_name() {
  Frame frame = heard();
  wire::Reader reader(frame.bytes);
  std::optional<wire::FrameHeader> header = wire::read_header(reader);
  if (!header) return frame;
  header->sender = frame.source = anybody();
  header->boot_id[0] = static_cast<std::uint8_t>(random_.next());
  header->counter += random_.next() % 1000;
  const std::size_t end = frame.bytes.size() - (sealed_ ? wire::kTagSize : wire::kChecksumSize);
  const Bytes body(frame.bytes.begin() + wire::kHeaderSize, frame.bytes.begin() + static_cast<std::ptrdiff_t>(end));
  frame.bytes = wire::close_openly(*header, body);
  return frame;
}

}  // namespace adhoc_communication::bench
