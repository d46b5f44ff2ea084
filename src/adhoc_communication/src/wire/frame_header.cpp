#include "wire/frame_header.hpp"

namespace adhoc_communication::wire {

void write(Writer& writer, const FrameHeader& header) {
  writer.u8(kVersion);
  writer.u8(static_cast<std::uint8_t>(header.type));
  writer.u8(header.flags);
  writer.octets(header.sender);
  writer.octets(header.boot_id);
  writer.u64(header.counter);
  writer.octets(header.next_hop);
  writer.u32(header.link_sequence);
}

std::optional<FrameHeader> read_header(Reader& reader) {
  if (reader.u8() != kVersion) return std::nullopt;
  FrameHeader header;
  const std::uint8_t type = reader.u8();
  if (type < static_cast<std::uint8_t>(FrameType::kBeacon) || type > static_cast<std::uint8_t>(FrameType::kFlood)) {
    return std::nullopt;
  }
  header.type = static_cast<FrameType>(type);
  header.flags = reader.u8();
  if ((header.flags & ~(kWantsAcknowledgment | kAcknowledgeNow)) != 0) return std::nullopt;
  header.sender = reader.address();
  header.boot_id = reader.octets<16>();
  header.counter = reader.u64();
  header.next_hop = reader.address();
  header.link_sequence = reader.u32();
  if (!reader.ok()) return std::nullopt;
  return header;
}

}  // namespace adhoc_communication::wire
