// Beacon, RREQ, RREP and RERR.
#include "wire/messages.hpp"

namespace adhoc_communication::wire {
namespace {

constexpr std::uint8_t kHelloInterval = 1;  ///< RFC 3561 section 9.1

/// RFC 3561 section 9: extensions of types 1 to 127 are skipped when unknown, others discard the message.
/// `interval_ms`: set by a Hello Interval extension.
bool read_extensions(Reader& reader, std::uint32_t& interval_ms) {
  while (reader.ok() && reader.left() > 0) {
    const std::uint8_t type = reader.u8();
    if (type == 0 || type > 127) return false;
    const std::uint8_t length = reader.u8();
    if (type == kHelloInterval && length == 4) {
      interval_ms = reader.u32();
    } else {
      reader.skip(length);
    }
  }
  return reader.at_end();
}

bool skip_extensions(Reader& reader) {
  std::uint32_t unused = 0;
  return read_extensions(reader, unused);
}

}  // namespace

void write(Writer& writer, const Beacon& beacon) {
  writer.u32(beacon.sequence_number);
  writer.u32(beacon.alive);
  writer.u16(beacon.number);
  writer.text8(beacon.name);
  writer.u16(beacon.heard_count);
  writer.u8(static_cast<std::uint8_t>(beacon.heard.size()));
  for (const HeardNeighbor& neighbor : beacon.heard) {
    writer.u32(static_cast<std::uint32_t>(neighbor.tag >> 16));
    writer.u16(static_cast<std::uint16_t>(neighbor.tag));
    writer.u8(neighbor.loss);
  }
  writer.u8(static_cast<std::uint8_t>(beacon.rumors.size()));
  for (const Rumor& rumor : beacon.rumors) {
    writer.octets(rumor.address);
    writer.u64(rumor.boot);
    writer.u32(rumor.alive);
    writer.u8(rumor.hops);
    writer.text8(rumor.name);
  }
  if (beacon.interval_ms == 0) return;
  writer.u8(kHelloInterval);
  writer.u8(4);
  writer.u32(beacon.interval_ms);
}

std::optional<Beacon> read_beacon(Reader reader) {
  Beacon beacon;
  beacon.sequence_number = reader.u32();
  beacon.alive = reader.u32();
  beacon.number = reader.u16();
  beacon.name = reader.text8();
  beacon.heard_count = reader.u16();
  const std::uint8_t heard = reader.u8();
  beacon.heard.reserve(heard);
  for (int left = heard; left > 0 && reader.ok(); --left) {
    const NeighborTag upper = reader.u32();
    const NeighborTag tag = upper << 16 | reader.u16();
    beacon.heard.push_back({tag, reader.u8()});
  }
  const std::uint8_t rumors = reader.u8();
  beacon.rumors.reserve(rumors);
  for (int left = rumors; left > 0 && reader.ok(); --left) {
    Rumor rumor{reader.individual_address(), reader.u64(), reader.u32(), reader.u8(), reader.text8()};
    if (!is_name(rumor.name) || rumor.hops == 0 || rumor.hops > kFarthestHop) return std::nullopt;
    beacon.rumors.push_back(std::move(rumor));
  }
  if (!read_extensions(reader, beacon.interval_ms) || !is_name(beacon.name)) return std::nullopt;
  return beacon;
}

void write(Writer& writer, const RouteRequest& request) {
  const int flags = (request.join ? 0x80 : 0) | (request.repair ? 0x40 : 0) | (request.gratuitous ? 0x20 : 0) |
                    (request.destination_only ? 0x10 : 0) | (request.unknown_sequence_number ? 0x08 : 0) |
                    (request.directed ? 0x04 : 0);
  writer.u8(static_cast<std::uint8_t>(flags));
  writer.u8(request.hop_count);
  writer.u8(request.hop_limit);
  writer.u16(request.cost);
  writer.u32(request.id);
  writer.octets(request.destination);
  writer.u32(request.destination_sequence);
  writer.octets(request.originator);
  writer.u32(request.originator_sequence);
  writer.u64(request.originator_boot);
  writer.text8(request.destination_name);
  writer.text8(request.originator_name);
}

std::optional<RouteRequest> read_route_request(Reader reader) {
  RouteRequest request;
  const std::uint8_t flags = reader.u8();
  request.join = (flags & 0x80) != 0;
  request.repair = (flags & 0x40) != 0;
  request.gratuitous = (flags & 0x20) != 0;
  request.destination_only = (flags & 0x10) != 0;
  request.unknown_sequence_number = (flags & 0x08) != 0;
  request.directed = (flags & 0x04) != 0;
  request.hop_count = reader.u8();
  request.hop_limit = reader.u8();
  request.cost = reader.u16();
  request.id = reader.u32();
  request.destination = reader.address();
  request.destination_sequence = reader.u32();
  request.originator = reader.individual_address();
  request.originator_sequence = reader.u32();
  request.originator_boot = reader.u64();
  request.destination_name = reader.text8();
  request.originator_name = reader.text8();
  if (!skip_extensions(reader)) return std::nullopt;
  if (!request.destination_name.empty() && !is_name(request.destination_name)) return std::nullopt;
  if (!is_name(request.originator_name)) return std::nullopt;
  if (request.destination == MacAddress{} && request.destination_name.empty()) return std::nullopt;
  if (request.hop_limit == 0 || request.hop_count >= kFarthestHop) return std::nullopt;
  return request;
}

void write(Writer& writer, const RouteReply& reply) {
  writer.u8(static_cast<std::uint8_t>((reply.repair ? 0x80 : 0) | (reply.acknowledgment_required ? 0x40 : 0)));
  writer.u8(reply.hop_count);
  writer.u16(reply.cost);
  writer.octets(reply.destination);
  writer.u32(reply.destination_sequence);
  writer.u64(reply.destination_boot);
  writer.octets(reply.originator);
  writer.u32(reply.lifetime_ms);
  writer.text8(reply.destination_name);
}

std::optional<RouteReply> read_route_reply(Reader reader) {
  RouteReply reply;
  const std::uint8_t flags = reader.u8();
  reply.repair = (flags & 0x80) != 0;
  reply.acknowledgment_required = (flags & 0x40) != 0;
  reply.hop_count = reader.u8();
  reply.cost = reader.u16();
  reply.destination = reader.individual_address();
  reply.destination_sequence = reader.u32();
  reply.destination_boot = reader.u64();
  reply.originator = reader.individual_address();
  reply.lifetime_ms = reader.u32();
  reply.destination_name = reader.text8();
  if (!skip_extensions(reader) || !is_name(reply.destination_name)) return std::nullopt;
  if (reply.hop_count >= kFarthestHop) return std::nullopt;
  return reply;
}

void write(Writer& writer, const RouteError& error) {
  writer.u8(static_cast<std::uint8_t>((error.no_delete ? 0x80 : 0) | (error.unknown_sequence ? 0x40 : 0)));
  writer.u8(static_cast<std::uint8_t>(error.destinations.size()));
  for (const UnreachableDestination& destination : error.destinations) {
    writer.octets(destination.address);
    writer.u32(destination.sequence);
  }
}

std::optional<RouteError> read_route_error(Reader reader) {
  RouteError error;
  const std::uint8_t flags = reader.u8();
  error.no_delete = (flags & 0x80) != 0;
  error.unknown_sequence = (flags & 0x40) != 0;
  const int count = reader.u8();
  for (int i = 0; i < count && reader.ok(); ++i) {
    error.destinations.push_back({reader.individual_address(), reader.u32()});
  }
  if (!skip_extensions(reader) || count == 0) return std::nullopt;
  return error;
}

}  // namespace adhoc_communication::wire
