#include "transport/packet_image.hpp"

#include <zstd.h>

#include <utility>

#include "wire/octets.hpp"

namespace adhoc_communication::transport {
namespace {

constexpr std::uint8_t kCompressed = 0x01;
constexpr std::uint8_t kLatched = 0x02;
constexpr std::size_t kFixedSize = 3 + 1 + 2 + 4;  ///< flags, kind, type; lengths of group and topic; payload size
constexpr std::size_t kWorthCompressing = 128;
constexpr int kLevel = 1;

/// The frame must admit to exactly the announced size before anything is allocated for it.
bool admits_to(const Bytes& compressed, std::size_t size) {
  return ZSTD_getFrameContentSize(compressed.data(), compressed.size()) == size;
}

}  // namespace

std::size_t image_size(const std::string& group, const std::string& topic, std::size_t payload) {
  return kFixedSize + group.size() + topic.size() + payload;
}

void pack(Bytes& payload, std::uint32_t& unpacked_size) {
  if (unpacked_size != 0 || payload.size() < kWorthCompressing) return;
  Bytes compressed(ZSTD_compressBound(payload.size()));
  const std::size_t size = ZSTD_compress(compressed.data(), compressed.size(), payload.data(), payload.size(), kLevel);
  if (ZSTD_isError(size) || size >= payload.size()) return;
  compressed.resize(size);
  compressed.shrink_to_fit();
  unpacked_size = static_cast<std::uint32_t>(payload.size());
  payload = std::move(compressed);
}

bool unpack(Bytes& payload, std::uint32_t& unpacked_size) {
  if (unpacked_size == 0) return true;
  if (!admits_to(payload, unpacked_size)) return false;
  Bytes unpacked(unpacked_size);
  const std::size_t written = ZSTD_decompress(unpacked.data(), unpacked.size(), payload.data(), payload.size());
  if (ZSTD_isError(written) || written != unpacked_size) return false;
  payload = std::move(unpacked);
  unpacked_size = 0;
  return true;
}

Image image_of(const Packet& packet) {
  auto image = std::make_shared<Bytes>();
  image->reserve(image_size(packet.group, packet.topic, packet.payload.size()));
  const bool packed = packet.unpacked_size != 0;
  wire::Writer writer(*image);
  writer.u8(static_cast<std::uint8_t>((packed ? kCompressed : 0) | (packet.latched ? kLatched : 0)));
  writer.u8(static_cast<std::uint8_t>(packet.kind));
  writer.u8(packet.payload_type);
  writer.text8(packet.group);
  writer.text16(packet.topic);
  writer.u32(packed ? packet.unpacked_size : static_cast<std::uint32_t>(packet.payload.size()));
  writer.octets(packet.payload);
  return image;
}

std::optional<Packet> parse(Bytes image, std::size_t largest) {
  wire::Reader reader(image);
  const std::uint8_t flags = reader.u8();
  const std::uint8_t kind = reader.u8();
  Packet packet;
  packet.payload_type = reader.u8();
  packet.group = reader.text8();
  packet.topic = reader.text16();
  const std::uint32_t size = reader.u32();
  if (!reader.ok() || (flags & ~(kCompressed | kLatched)) != 0 || size > largest) return std::nullopt;
  if (kind > static_cast<std::uint8_t>(PacketKind::kGroupCopy)) return std::nullopt;
  // The image becomes the payload: two of the largest packets at once would be much.
  image.erase(image.begin(), image.end() - static_cast<std::ptrdiff_t>(reader.left()));
  packet.payload = std::move(image);
  packet.kind = static_cast<PacketKind>(kind);
  packet.latched = (flags & kLatched) != 0;
  if ((flags & kCompressed) != 0) {
    if (size == 0 || !admits_to(packet.payload, size)) return std::nullopt;
    packet.unpacked_size = size;
  } else if (packet.payload.size() != size) {
    return std::nullopt;
  }
  return packet;
}

Image encode(Packet packet) {
  pack(packet.payload, packet.unpacked_size);
  return image_of(packet);
}

std::optional<Packet> decode(Bytes image, std::size_t largest) {
  std::optional<Packet> packet = parse(std::move(image), largest);
  if (packet && !unpack(packet->payload, packet->unpacked_size)) return std::nullopt;
  return packet;
}

}  // namespace adhoc_communication::transport
