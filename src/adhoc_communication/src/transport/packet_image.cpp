#include "transport/packet_image.hpp"

#include <zstd.h>

#include "wire/octets.hpp"

namespace adhoc_communication::transport {
namespace {

constexpr std::uint8_t kCompressed = 0x01;
constexpr std::uint8_t kLatched = 0x02;
constexpr std::size_t kFixedSize = 3 + 1 + 2 + 4;  ///< flags, kind, type; lengths of group and topic; payload size
constexpr std::size_t kWorthCompressing = 128;
constexpr int kLevel = 1;

std::optional<Bytes> compress(const Bytes& payload) {
  if (payload.size() < kWorthCompressing) return std::nullopt;
  Bytes compressed(ZSTD_compressBound(payload.size()));
  const std::size_t size = ZSTD_compress(compressed.data(), compressed.size(), payload.data(), payload.size(), kLevel);
  if (ZSTD_isError(size) || size >= payload.size()) return std::nullopt;
  compressed.resize(size);
  return compressed;
}

std::optional<Bytes> decompress(const Bytes& compressed, std::size_t size) {
  // The frame must admit to exactly the announced size before anything is allocated for it.
  if (ZSTD_getFrameContentSize(compressed.data(), compressed.size()) != size) return std::nullopt;
  Bytes payload(size);
  const std::size_t written = ZSTD_decompress(payload.data(), size, compressed.data(), compressed.size());
  if (ZSTD_isError(written) || written != size) return std::nullopt;
  return payload;
}

}  // namespace

std::size_t image_size(const std::string& group, const std::string& topic, std::size_t payload) {
  return kFixedSize + group.size() + topic.size() + payload;
}

Image encode(const Packet& packet) {
  const std::optional<Bytes> compressed = compress(packet.payload);
  const Bytes& body = compressed ? *compressed : packet.payload;
  auto image = std::make_shared<Bytes>();
  image->reserve(image_size(packet.group, packet.topic, body.size()));
  wire::Writer writer(*image);
  writer.u8(static_cast<std::uint8_t>((compressed ? kCompressed : 0) | (packet.latched ? kLatched : 0)));
  writer.u8(static_cast<std::uint8_t>(packet.kind));
  writer.u8(packet.payload_type);
  writer.text8(packet.group);
  writer.text16(packet.topic);
  writer.u32(static_cast<std::uint32_t>(packet.payload.size()));
  writer.octets(body);
  return image;
}

std::optional<Packet> decode(const Bytes& image, std::size_t largest) {
  wire::Reader reader(image);
  const std::uint8_t flags = reader.u8();
  const std::uint8_t kind = reader.u8();
  Packet packet;
  packet.payload_type = reader.u8();
  packet.group = reader.text8();
  packet.topic = reader.text16();
  const std::size_t size = reader.u32();
  Bytes body = reader.rest();
  if (!reader.ok() || (flags & ~(kCompressed | kLatched)) != 0 || size > largest) return std::nullopt;
  if (kind > static_cast<std::uint8_t>(PacketKind::kGroupCopy)) return std::nullopt;
  packet.kind = static_cast<PacketKind>(kind);
  packet.latched = (flags & kLatched) != 0;
  if ((flags & kCompressed) != 0) {
    std::optional<Bytes> payload = decompress(body, size);
    if (!payload) return std::nullopt;
    packet.payload = std::move(*payload);
  } else {
    if (body.size() != size) return std::nullopt;
    packet.payload = std::move(body);
  }
  return packet;
}

}  // namespace adhoc_communication::transport
