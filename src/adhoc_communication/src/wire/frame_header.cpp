#include "wire/frame_header.hpp"

#include <isa-l/crc.h>

namespace adhoc_communication::wire {
namespace {

/// CRC-32 of IEEE 802.3, reflected.
std::uint32_t checksum(const std::uint8_t* data, std::size_t size) { return crc32_gzip_refl(0, data, size); }

}  // namespace

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
  if (type < static_cast<std::uint8_t>(FrameType::kBeacon) || type >= Statistics::kFrameTypes) return std::nullopt;
  header.type = static_cast<FrameType>(type);
  header.flags = reader.u8();
  if ((header.flags & ~(kSealed | kWantsAcknowledgment | kAcknowledgeNow)) != 0) return std::nullopt;
  header.sender = reader.individual_address();
  header.boot_id = reader.octets<16>();
  header.counter = reader.u64();
  header.next_hop = reader.address();
  header.link_sequence = reader.u32();
  if (!reader.ok()) return std::nullopt;
  return header;
}

Bytes close_openly(const FrameHeader& header, const Bytes& body) {
  Bytes frame;
  frame.reserve(kHeaderSize + body.size() + kChecksumSize);
  Writer writer(frame);
  write(writer, header);
  writer.octets(body);
  writer.u32(checksum(frame.data(), frame.size()));
  return frame;
}

std::optional<Reader> open_body(const Bytes& frame) {
  if (frame.size() < kHeaderSize + kChecksumSize) return std::nullopt;
  const std::size_t size = frame.size() - kChecksumSize;
  if (Reader(frame.data() + size, kChecksumSize).u32() != checksum(frame.data(), size)) return std::nullopt;
  return Reader(frame.data() + kHeaderSize, size - kHeaderSize);
}

}  // namespace adhoc_communication::wire
