// Acknowledgments, segments and floods.
#include "wire/messages.hpp"

namespace adhoc_communication::wire {
namespace {

constexpr std::uint8_t kStreamMask = 0x03;
constexpr std::uint8_t kAcknowledgeNowFlag = 0x80;

/// A segment must be of the length that its index, the segment size and the total say.
bool segment_fits(std::uint32_t index, std::uint32_t total, std::uint16_t segment_size, std::size_t octets) {
  if (segment_size == 0 || segment_size > kLongestSegment || total == 0) return false;
  if (segment_size < kShortestSegment && total > segment_size) return false;
  const std::uint64_t begin = std::uint64_t{index} * segment_size;
  if (begin >= total) return false;
  return octets == std::min<std::uint64_t>(segment_size, total - begin);
}

}  // namespace

void write(Writer& writer, const HopAcknowledgment& acknowledgment) {
  writer.u64(acknowledgment.boot);
  writer.u64(acknowledgment.newest_counter);
  writer.u32(acknowledgment.spacing_ns);
  writer.u32(acknowledgment.held_ns);
  writer.u32(acknowledgment.highest);
  writer.u64(acknowledgment.received);
}

std::optional<HopAcknowledgment> read_hop_acknowledgment(Reader reader) {
  HopAcknowledgment acknowledgment{reader.u64(), reader.u64(), reader.u32(), reader.u32(), reader.u32(), reader.u64()};
  if (!reader.at_end()) return std::nullopt;
  return acknowledgment;
}

void write(Writer& writer, const Data& data) {
  writer.octets(data.source);
  writer.u64(data.source_boot);
  writer.octets(data.destination);
  writer.u8(static_cast<std::uint8_t>(data.stream | (data.acknowledge_now ? kAcknowledgeNowFlag : 0)));
  writer.u8(data.hops);
  writer.u32(data.packet);
  writer.u32(data.base);
  writer.u32(data.index);
  writer.u32(data.total);
  writer.u16(data.segment_size);
  writer.u8(data.attempt);
  writer.octets(data.octets);
}

std::optional<Data> read_data(Reader reader) {
  Data data;
  data.source = reader.individual_address();
  data.source_boot = reader.u64();
  data.destination = reader.individual_address();
  const std::uint8_t stream = reader.u8();
  data.stream = stream & kStreamMask;
  data.acknowledge_now = (stream & kAcknowledgeNowFlag) != 0;
  data.hops = reader.u8();
  data.packet = reader.u32();
  data.base = reader.u32();
  data.index = reader.u32();
  data.total = reader.u32();
  data.segment_size = reader.u16();
  data.attempt = reader.u8();
  data.octets = reader.rest();
  if (!reader.ok() || (stream & ~(kStreamMask | kAcknowledgeNowFlag)) != 0) return std::nullopt;
  if (data.hops == 0 || data.hops > kFarthestHop) return std::nullopt;
  if (!segment_fits(data.index, data.total, data.segment_size, data.octets.size())) return std::nullopt;
  return data;
}

void write(Writer& writer, const TransportAcknowledgment& acknowledgment) {
  writer.octets(acknowledgment.source);
  writer.u64(acknowledgment.source_boot);
  writer.octets(acknowledgment.destination);
  writer.u64(acknowledgment.destination_boot);
  writer.u8(acknowledgment.stream);
  writer.u8(acknowledgment.hops);
  writer.u32(acknowledgment.next);
  writer.u8(static_cast<std::uint8_t>(acknowledgment.partial.size()));
  for (const PartialPacket& partial : acknowledgment.partial) {
    writer.u32(partial.packet);
    writer.u8(partial.attempt);
    writer.u32(partial.first_missing);
    writer.u8(static_cast<std::uint8_t>(partial.received.size()));
    writer.octets(partial.received);
  }
  writer.u8(static_cast<std::uint8_t>(acknowledgment.refused.size()));
  for (const RefusedPacket& refused : acknowledgment.refused) {
    writer.u32(refused.packet);
    writer.u8(refused.attempt);
  }
}

std::optional<TransportAcknowledgment> read_transport_acknowledgment(Reader reader) {
  TransportAcknowledgment acknowledgment;
  acknowledgment.source = reader.individual_address();
  acknowledgment.source_boot = reader.u64();
  acknowledgment.destination = reader.individual_address();
  acknowledgment.destination_boot = reader.u64();
  acknowledgment.stream = reader.u8();
  acknowledgment.hops = reader.u8();
  acknowledgment.next = reader.u32();
  for (int left = reader.u8(); left > 0 && reader.ok(); --left) {
    PartialPacket partial{reader.u32(), reader.u8(), reader.u32(), {}};
    const std::size_t size = reader.u8();
    for (std::size_t i = 0; i < size; ++i) partial.received.push_back(reader.u8());
    acknowledgment.partial.push_back(std::move(partial));
  }
  for (int left = reader.u8(); left > 0 && reader.ok(); --left) {
    acknowledgment.refused.push_back({reader.u32(), reader.u8()});
  }
  if (!reader.at_end() || acknowledgment.stream > kStreamMask) return std::nullopt;
  if (acknowledgment.hops == 0 || acknowledgment.hops > kFarthestHop) return std::nullopt;
  return acknowledgment;
}

void write(Writer& writer, const BroadcastData& data) {
  writer.u32(data.packet);
  writer.u32(data.index);
  writer.u32(data.total);
  writer.u16(data.segment_size);
  writer.octets(data.octets);
}

std::optional<BroadcastData> read_broadcast_data(Reader reader) {
  BroadcastData data{reader.u32(), reader.u32(), reader.u32(), reader.u16(), {}};
  data.octets = reader.rest();
  if (!reader.ok() || !segment_fits(data.index, data.total, data.segment_size, data.octets.size())) {
    return std::nullopt;
  }
  return data;
}

void write(Writer& writer, const Flood& flood) {
  writer.octets(flood.source);
  writer.u64(flood.source_boot);
  writer.u32(flood.id);
  writer.u8(flood.hop_count);
  writer.u8(flood.hop_limit);
  writer.text8(flood.source_name);
  writer.octets(flood.image);
}

std::optional<Flood> read_flood(Reader reader) {
  Flood flood;
  flood.source = reader.individual_address();
  flood.source_boot = reader.u64();
  flood.id = reader.u32();
  flood.hop_count = reader.u8();
  flood.hop_limit = reader.u8();
  flood.source_name = reader.text8();
  flood.image = reader.rest();
  if (!reader.ok() || !is_name(flood.source_name)) return std::nullopt;
  if (flood.hop_limit == 0 || flood.hop_count == 255) return std::nullopt;
  return flood;
}

}  // namespace adhoc_communication::wire
