#include "wire/frame_header.hpp"

#include <array>

namespace adhoc_communication::wire {
namespace {

constexpr std::size_t kSlice = 8;  ///< octets taken at once: every frame heard goes through here
using Tables = std::array<std::array<std::uint32_t, 256>, kSlice>;

/// CRC-32 of IEEE 802.3, reflected. Table i is for an octet with i more behind it in the slice.
constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t octet = 0; octet < 256; ++octet) {
    std::uint32_t value = octet;
    for (int bit = 0; bit < 8; ++bit) value = (value & 1) != 0 ? value >> 1 ^ 0xedb88320u : value >> 1;
    tables[0][octet] = value;
  }
  for (std::size_t i = 1; i < kSlice; ++i) {
    for (std::size_t octet = 0; octet < 256; ++octet) {
      const std::uint32_t before = tables[i - 1][octet];
      tables[i][octet] = tables[0][before & 0xff] ^ before >> 8;
    }
  }
  return tables;
}

constexpr Tables kTables = make_tables();

std::uint32_t checksum(const std::uint8_t* data, std::size_t size) {
  std::uint32_t value = 0xffffffffu;
  for (; size >= kSlice; data += kSlice, size -= kSlice) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < kSlice; ++i) {
      const std::uint32_t folded = i < 4 ? value >> 8 * i & 0xff : 0;
      next ^= kTables[kSlice - 1 - i][folded ^ data[i]];
    }
    value = next;
  }
  for (; size > 0; ++data, --size) value = kTables[0][(value ^ *data) & 0xff] ^ value >> 8;
  return ~value;
}

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
  if (type < static_cast<std::uint8_t>(FrameType::kBeacon) ||
      type > static_cast<std::uint8_t>(FrameType::kRouteReplyAcknowledgment)) {
    return std::nullopt;
  }
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
