#include "protocol_vectors.hpp"

#include <cstdio>
#include <numeric>
#include <utility>

#include "multicast/group_packet.hpp"
#include "multicast/groups.hpp"
#include "multicast/tree.hpp"
#include "payloads.hpp"
#include "security/cipher.hpp"
#include "transport/packet_image.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using transport::PacketKind;
using wire::FrameType;

// JSON.

using Members = std::vector<std::pair<std::string, std::string>>;

std::string number(std::uint64_t value) { return std::to_string(value); }
std::string quoted(const std::string& text) { return '"' + text + '"'; }

template <typename Octets>
std::string hex(const Octets& octets) {
  std::string text;
  char digits[3];
  for (const std::uint8_t octet : octets) {
    std::snprintf(digits, sizeof digits, "%02x", octet);
    text += digits;
  }
  return quoted(text);
}

std::string joined(const std::vector<std::string>& parts, const std::string& separator) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : separator) + part;
  return text;
}

std::string object(const Members& members, const std::string& separator = ", ") {
  std::vector<std::string> parts;
  for (const auto& [name, value] : members) parts.push_back(quoted(name) + ": " + value);
  return '{' + joined(parts, separator) + '}';
}

template <typename Items, typename Text>
std::string list(const Items& items, Text text) {
  std::vector<std::string> parts;
  for (const auto& item : items) parts.push_back(text(item));
  return '[' + joined(parts, ", ") + ']';
}

/// A number that is told by its octets.
std::string tag(std::uint64_t value, int octets = 8) {
  Bytes bytes;
  for (int shift = 8 * (octets - 1); shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
  return hex(bytes);
}

std::string addresses(const std::vector<MacAddress>& members) {
  return list(members, [](const MacAddress& member) { return object({{"address", hex(member)}}); });
}

// The fields of each message, in their order.

std::string fields(const wire::Beacon& beacon) {
  const std::string heard = list(beacon.heard, [](const wire::HeardNeighbor& neighbor) {
    return object({{"tag", tag(neighbor.tag, 6)}, {"loss", number(neighbor.loss)}});
  });
  const std::string rumors = list(beacon.rumors, [](const wire::Rumor& rumor) {
    return object({{"address", hex(rumor.address)},
                   {"boot_tag", tag(rumor.boot)},
                   {"life_sign", number(rumor.alive)},
                   {"hops", number(rumor.hops)},
                   {"name", quoted(rumor.name)}});
  });
  Members extensions;
  if (beacon.interval_ms != 0) extensions = {{"1", tag(beacon.interval_ms, 4)}};
  return object({{"sequence", number(beacon.sequence_number)},
                 {"life_sign", number(beacon.alive)},
                 {"number", number(beacon.number)},
                 {"name", quoted(beacon.name)},
                 {"heard_count", number(beacon.heard_count)},
                 {"heard", heard},
                 {"rumors", rumors},
                 {"extensions", object(extensions)}});
}

std::string fields(const wire::RouteRequest& request) {
  return object({{"flags", number(to_bytes(request).front())},
                 {"hop_count", number(request.hop_count)},
                 {"hop_limit", number(request.hop_limit)},
                 {"cost", number(request.cost)},
                 {"id", number(request.id)},
                 {"destination", hex(request.destination)},
                 {"destination_sequence", number(request.destination_sequence)},
                 {"originator", hex(request.originator)},
                 {"originator_sequence", number(request.originator_sequence)},
                 {"originator_boot_tag", tag(request.originator_boot)},
                 {"destination_name", quoted(request.destination_name)},
                 {"originator_name", quoted(request.originator_name)},
                 {"extensions", object({})}});
}

std::string fields(const wire::RouteReply& reply) {
  return object({{"flags", number(to_bytes(reply).front())},
                 {"hop_count", number(reply.hop_count)},
                 {"cost", number(reply.cost)},
                 {"destination", hex(reply.destination)},
                 {"destination_sequence", number(reply.destination_sequence)},
                 {"destination_boot_tag", tag(reply.destination_boot)},
                 {"originator", hex(reply.originator)},
                 {"lifetime", number(reply.lifetime_ms)},
                 {"destination_name", quoted(reply.destination_name)},
                 {"extensions", object({})}});
}

std::string fields(const wire::RouteError& error) {
  const std::string destinations = list(error.destinations, [](const wire::UnreachableDestination& destination) {
    return object({{"address", hex(destination.address)}, {"sequence", number(destination.sequence)}});
  });
  return object(
      {{"flags", number(to_bytes(error).front())}, {"destinations", destinations}, {"extensions", object({})}});
}

std::string fields(const wire::HopAcknowledgment& acknowledgment) {
  return object({{"boot_tag", tag(acknowledgment.boot)},
                 {"newest_counter", number(acknowledgment.newest_counter)},
                 {"spacing", number(acknowledgment.spacing_ns)},
                 {"held", number(acknowledgment.held_ns)},
                 {"highest", number(acknowledgment.highest)},
                 {"received", tag(acknowledgment.received)}});
}

std::string fields(const wire::Data& data) {
  return object({{"source", hex(data.source)},
                 {"source_boot_tag", tag(data.source_boot)},
                 {"destination", hex(data.destination)},
                 {"stream", number(data.stream | (data.acknowledge_now ? 0x80u : 0u))},
                 {"hops", number(data.hops)},
                 {"packet", number(data.packet)},
                 {"base", number(data.base)},
                 {"index", number(data.index)},
                 {"total", number(data.total)},
                 {"segment_size", number(data.segment_size)},
                 {"attempt", number(data.attempt)},
                 {"octets", hex(data.octets)}});
}

std::string fields(const wire::TransportAcknowledgment& acknowledgment) {
  const std::string partial = list(acknowledgment.partial, [](const wire::PartialPacket& packet) {
    return object({{"packet", number(packet.packet)},
                   {"attempt", number(packet.attempt)},
                   {"first_missing", number(packet.first_missing)},
                   {"received", hex(packet.received)}});
  });
  const std::string refused = list(acknowledgment.refused, [](const wire::RefusedPacket& packet) {
    return object({{"packet", number(packet.packet)}, {"attempt", number(packet.attempt)}});
  });
  return object({{"source", hex(acknowledgment.source)},
                 {"source_boot_tag", tag(acknowledgment.source_boot)},
                 {"destination", hex(acknowledgment.destination)},
                 {"destination_boot_tag", tag(acknowledgment.destination_boot)},
                 {"stream", number(acknowledgment.stream)},
                 {"hops", number(acknowledgment.hops)},
                 {"next", number(acknowledgment.next)},
                 {"partial", partial},
                 {"refused", refused}});
}

std::string fields(const wire::BroadcastData& data) {
  return object({{"packet", number(data.packet)},
                 {"index", number(data.index)},
                 {"total", number(data.total)},
                 {"segment_size", number(data.segment_size)},
                 {"octets", hex(data.octets)}});
}

std::string fields(const wire::Flood& flood) {
  return object({{"source", hex(flood.source)},
                 {"source_boot_tag", tag(flood.source_boot)},
                 {"id", number(flood.id)},
                 {"hop_count", number(flood.hop_count)},
                 {"hop_limit", number(flood.hop_limit)},
                 {"source_name", quoted(flood.source_name)},
                 {"image", hex(flood.image)}});
}

template <typename Branch>
std::string branch_fields(const Branch& branch) {
  return object({{"root", hex(branch.root)},
                 {"root_boot_tag", tag(branch.root_boot)},
                 {"epoch", number(branch.epoch)},
                 {"members", addresses(branch.members)}});
}

std::string fields(const wire::GroupActivation& activation) { return branch_fields(activation); }
std::string fields(const wire::GroupRefusal& refusal) { return branch_fields(refusal); }

std::string fields(const wire::GroupData& data) {
  return object({{"root", hex(data.root)},
                 {"root_boot_tag", tag(data.root_boot)},
                 {"stream", number(data.stream | (data.report ? 0x80u : 0u) | (data.follows ? 0x40u : 0u) |
                                   (data.flooded ? 0x20u : 0u))},
                 {"hops", number(data.hops)},
                 {"round", number(data.round)},
                 {"packet", number(data.packet)},
                 {"base", number(data.base)},
                 {"total", number(data.total)},
                 {"segment_size", number(data.segment_size)},
                 {"block", number(data.block)},
                 {"symbol", number(data.symbol)},
                 {"octets", hex(data.octets)}});
}

std::string fields(const wire::GroupReceipts& receipts) {
  const std::string items = list(receipts.receipts, [](const wire::GroupReceipt& receipt) {
    return object({{"root", hex(receipt.root)},
                   {"root_boot_tag", tag(receipt.root_boot)},
                   {"stream", number(receipt.stream | (receipt.by_route ? 0x80u : 0u))},
                   {"member", hex(receipt.member)},
                   {"next", number(receipt.next)},
                   {"beyond", number(receipt.beyond)}});
  });
  return object({{"receipts", items}});
}

std::string fields(const wire::GroupReport& report) {
  return object({{"root", hex(report.root)},
                 {"root_boot_tag", tag(report.root_boot)},
                 {"stream", number(report.stream | (report.complete ? 0x80u : 0u))},
                 {"packet", number(report.packet)},
                 {"epoch", number(report.epoch)},
                 {"round", number(report.round)},
                 {"measured_counter", number(report.measured_counter)},
                 {"spacing", number(report.spacing_ns)},
                 {"coverage", number(report.coverage)},
                 {"first_block", number(report.first_block)},
                 {"missing", hex(report.missing)}});
}

// The examples: Alice speaks; Bob is in reach, Carol behind him.

BootId boot_id(std::uint8_t first) {
  BootId id{};
  std::iota(id.begin(), id.end(), first);
  return id;
}

const Identity kAlice{"alice", {2, 0, 0, 0, 0, 1}, boot_id(0x10), wire::boot_tag(boot_id(0x10))};
const Identity kBob{"bob", {2, 0, 0, 0, 0, 2}, boot_id(0x20), wire::boot_tag(boot_id(0x20))};
const Identity kCarol{"carol", {2, 0, 0, 0, 0, 3}, boot_id(0x30), wire::boot_tag(boot_id(0x30))};

constexpr std::uint16_t kSegmentSize = 64;

/// 132 octets: two segments of 64 and one of 4. The payload is too short to be compressed.
Bytes packet_image() {
  const std::string line = "The quick brown fox jumps over the lazy dog. 0123456789. ";
  return *transport::encode({PacketKind::kUser, 'A', "", "greeting", text(line + line), true});
}

/// 200 times "a" as one block of repetition (RFC 8878 section 3.1.1): what the library makes of it depends on its
/// version.
Bytes compressed_image() {
  return {0x03, 0x00, 'A',  0,    0,    5,    't',  'o',  'p',  'i',  'c',  0,  0,
          0,    200,  0x28, 0xb5, 0x2f, 0xfd, 0x20, 0xc8, 0x43, 0x06, 0x00, 'a'};
}

Bytes segment(std::size_t index) {
  const Bytes image = packet_image();
  const auto begin = image.begin() + static_cast<std::ptrdiff_t>(index * kSegmentSize);
  const auto left = image.size() - index * kSegmentSize;
  return {begin, begin + static_cast<std::ptrdiff_t>(std::min<std::size_t>(kSegmentSize, left))};
}

class Examples {
 public:
  template <typename Message>
  void add(const std::string& name, FrameType type, const Message& message, std::uint8_t flags,
           const MacAddress& next_hop = kBob.address) {
    add_body(name, type, to_bytes(message), fields(message), flags, next_hop);
  }
  void add_body(const std::string& name, FrameType type, Bytes body, std::string fields, std::uint8_t flags,
                const MacAddress& next_hop) {
    const auto counter = 0x0102 + frames.size();
    const bool numbered = (flags & wire::kWantsAcknowledgment) != 0;
    const auto link_sequence = static_cast<std::uint32_t>(numbered ? 0x40 + frames.size() : 0);
    frames.push_back({name,
                      {type, flags, kAlice.address, kAlice.boot_id, counter, next_hop, link_sequence},
                      std::move(body),
                      std::move(fields)});
  }

  std::vector<FrameVector> frames;
};

constexpr std::uint8_t kAcknowledged = wire::kWantsAcknowledgment;
constexpr std::uint8_t kAtOnce = wire::kWantsAcknowledgment | wire::kAcknowledgeNow;

void add_presence(Examples& examples) {
  const wire::HeardNeighbor bob{wire::neighbor_tag(kBob.boot), 51};
  examples.add("beacon", FrameType::kBeacon,
               wire::Beacon{5, 6, 3, "alice", 1, {bob}, {{kCarol.address, kCarol.boot, 3, 2, "carol"}}, 250}, 0,
               wire::kEverybody);
  examples.add("beacon to one", FrameType::kBeacon, wire::Beacon{5, 7, 3, "alice", 0, {bob}, {}, 0}, kAtOnce);
}

void add_routing(Examples& examples) {
  examples.add("route request", FrameType::kRouteRequest,
               wire::RouteRequest{false, false, true, true, false, 0, 35, 0, 42, kCarol.address, 9, "carol",
                                  kAlice.address, 11, kAlice.boot, "alice"},
               0, wire::kEverybody);
  examples.add(
      "route request by name", FrameType::kRouteRequest,
      wire::RouteRequest{
          false, false, true, true, true, 1, 34, 16, 43, {}, 0, "carol", kAlice.address, 12, kAlice.boot, "alice"},
      kAcknowledged);
  examples.add("route reply", FrameType::kRouteReply,
               wire::RouteReply{false, false, 1, 16, kCarol.address, 10, kCarol.boot, "carol", kBob.address, 20000},
               kAcknowledged);
  examples.add("route error", FrameType::kRouteError,
               wire::RouteError{false, false, {{kCarol.address, 11}, {{2, 0, 0, 0, 0, 4}, 7}}}, kAcknowledged);
  examples.add("hop acknowledgment", FrameType::kHopAcknowledgment,
               wire::HopAcknowledgment{kBob.boot, 0x0209, 1'200'000, 800'000, 0x55, 0xfffffffffffffffb}, 0);
  examples.add_body("route reply acknowledgment", FrameType::kRouteReplyAcknowledgment, {}, object({}), 0,
                    kBob.address);
}

void add_packets(Examples& examples) {
  const auto total = static_cast<std::uint32_t>(packet_image().size());
  const auto data = [&](std::uint32_t index, bool at_once) {
    return wire::Data{kAlice.address, kAlice.boot, kCarol.address, 2, at_once,       1, 9, 8,
                      index,          total,       kSegmentSize,   0, segment(index)};
  };
  examples.add("data", FrameType::kData, data(0, false), kAcknowledged);
  examples.add("data, last segment", FrameType::kData, data(2, true), kAcknowledged);
  examples.add("transport acknowledgment", FrameType::kTransportAcknowledgment,
               wire::TransportAcknowledgment{kAlice.address,
                                             kAlice.boot,
                                             kCarol.address,
                                             kCarol.boot,
                                             2,
                                             1,
                                             20,
                                             {{21, 1, 4, {0x0f, 0x01}}, {22, 0, 0, {}}},
                                             {{23, 2}}},
               kAcknowledged);
  examples.add("broadcast data", FrameType::kBroadcastData, wire::BroadcastData{3, 1, total, kSegmentSize, segment(1)},
               0, wire::kEverybody);
  examples.add("flood", FrameType::kFlood,
               wire::Flood{kAlice.address, kAlice.boot, 4, 0, 3, "alice", compressed_image()}, 0, wire::kEverybody);
}

void add_groups(Examples& examples) {
  const std::vector<MacAddress> members{kBob.address, kCarol.address};
  examples.add("group activation", FrameType::kGroupActivation,
               wire::GroupActivation{kAlice.address, kAlice.boot, 7, members}, kAcknowledged);
  examples.add("group refusal", FrameType::kGroupRefusal,
               wire::GroupRefusal{kCarol.address, kCarol.boot, 7, {kAlice.address}}, kAcknowledged);
  const multicast::GroupPacket packet(packet_image(), kSegmentSize);
  const auto data = [&](std::uint8_t symbol, bool report, Bytes octets) {
    return wire::GroupData{
        kAlice.address, kAlice.boot, 1,      report,           false, false, 1, 5, 31, 30, packet.total(),
        kSegmentSize,   0,           symbol, std::move(octets)};
  };
  examples.add("group data", FrameType::kGroupData, data(2, true, packet.symbol(0, 2)), 0, wire::kEverybody);
  examples.add("group data, parity", FrameType::kGroupData, data(3, true, packet.symbol(0, 3)), 0);
  const Bytes image = packet_image();
  wire::GroupData flooded{kAlice.address, kAlice.boot, 1, false, false, true, 2, 0, 32, 31,
                          packet.total(), 1400,        0, 0,     image};
  examples.add("group data, flooded", FrameType::kGroupData, flooded, 0, wire::kEverybody);
  examples.add("group data, question", FrameType::kGroupData, data(0, true, {}), kAcknowledged);
  wire::GroupReport report{kCarol.address, kCarol.boot, 1, 31, 7, 5, false, 0x0207, 1'300'000, 0, 2, {3, 0}};
  report.coverage = multicast::digest(kAlice.address);
  examples.add("group report", FrameType::kGroupReport, report, 0);
  report.complete = true;
  report.first_block = 4;
  report.missing.clear();
  examples.add("group report, complete", FrameType::kGroupReport, report, kAcknowledged);
  const wire::GroupReceipts receipts{{{kAlice.address, kAlice.boot, 1, kBob.address, 33, 0},
                                      {kAlice.address, kAlice.boot, 1, kCarol.address, 31, 2, true}}};
  examples.add("group receipts", FrameType::kGroupReceipts, receipts, kAcknowledged);
}

// The parts of the file.

security::SessionKey alices_session_key() {
  security::SessionKey key;
  security::derive_session_key(key, vector_team_key(), kAlice.address, kAlice.boot_id);
  return key;
}

std::string frame_text(const FrameVector& frame) {
  wire::FrameHeader sealed = frame.header;
  sealed.flags |= wire::kSealed;
  const security::SessionKey key = alices_session_key();
  const std::string header = object({{"type", number(static_cast<std::uint8_t>(frame.header.type))},
                                     {"flags", number(frame.header.flags)},
                                     {"sender", hex(frame.header.sender)},
                                     {"boot_id", hex(frame.header.boot_id)},
                                     {"counter", number(frame.header.counter)},
                                     {"next_hop", hex(frame.header.next_hop)},
                                     {"link_sequence", number(frame.header.link_sequence)}});
  return object({{"name", quoted(frame.name)},
                 {"header", header},
                 {"fields", frame.fields},
                 {"open", hex(wire::close_openly(frame.header, frame.body))},
                 {"sealed", hex(security::seal(key, sealed, frame.body))}},
                ",\n   ");
}

struct ImageVector {
  std::string name;
  Bytes octets;
};

std::string image_text(const ImageVector& image) {
  const transport::Packet packet = transport::decode(image.octets, 100'000).value();
  const std::string values = object({{"flags", number(image.octets[0])},
                                     {"kind", number(image.octets[1])},
                                     {"payload_type", number(image.octets[2])},
                                     {"group", quoted(packet.group)},
                                     {"topic", quoted(packet.topic)},
                                     {"payload_size", number(packet.payload.size())},
                                     {"payload", hex(packet.payload)}});
  return object({{"name", quoted(image.name)}, {"fields", values}, {"octets", hex(image.octets)}}, ",\n   ");
}

/// Uncompressed, as any packet may be.
Bytes copy_image(const std::string& group) {
  const Bytes payload = multicast::encode_copy({1, 31, std::make_shared<Bytes>(packet_image()), Time(0)});
  Bytes image{0, static_cast<std::uint8_t>(PacketKind::kGroupCopy), 0};
  wire::Writer writer(image);
  writer.text8(group);
  writer.text16("");
  writer.u32(static_cast<std::uint32_t>(payload.size()));
  writer.octets(payload);
  return image;
}

std::vector<ImageVector> images() {
  const std::string group = "mc_alice";
  const Bytes members = multicast::encode_members({"alice", "bob"});
  return {{"user", packet_image()},
          {"user, compressed", compressed_image()},
          {"group join", *transport::encode({PacketKind::kGroupJoin, 0, group, {}, {}})},
          {"group members", *transport::encode({PacketKind::kGroupMembers, 0, group, {}, members})},
          {"group copy", copy_image(group)}};
}

std::string blocks_text(std::uint32_t total) {
  const multicast::GroupPacket packet(total, kSegmentSize);
  const std::string frames = list(
      packet.blocks(), [](const multicast::Block& block) { return number(static_cast<unsigned>(block.frames())); });
  return object({{"total", number(total)}, {"segment_size", number(kSegmentSize)}, {"frames", frames}});
}

/// Symbols of a block of five frames, the last of which is padded with zeros.
std::string parity_text() {
  Bytes image(300);
  std::iota(image.begin(), image.end(), std::uint8_t{0});
  const multicast::GroupPacket packet(image, kSegmentSize);
  const std::vector<int> symbols{5, 6, 255};
  const std::string parities = list(symbols, [&](int symbol) {
    return object(
        {{"symbol", number(static_cast<unsigned>(symbol))}, {"octets", hex(packet.blocks()[0].symbol(symbol))}});
  });
  return object({{"image", hex(image)}, {"segment_size", number(kSegmentSize)}, {"parity", parities}}, ",\n  ");
}

template <typename Items, typename Text>
std::string lines(const Items& items, Text text) {
  std::vector<std::string> parts;
  for (const auto& item : items) parts.push_back(text(item));
  return "[\n  " + joined(parts, ",\n  ") + "\n ]";
}

}  // namespace

Identity vector_receiver() { return kBob; }

TeamKey vector_team_key() {
  TeamKey key{};
  std::iota(key.begin(), key.end(), std::uint8_t{0x80});
  return key;
}

std::vector<FrameVector> frame_vectors() {
  Examples examples;
  add_presence(examples);
  add_routing(examples);
  add_packets(examples);
  add_groups(examples);
  return examples.frames;
}

std::string protocol_vectors() {
  const security::SessionKey key = alices_session_key();
  const std::vector<MacAddress> members{kAlice.address, kBob.address, kCarol.address};
  const std::string digests = lines(members, [](const MacAddress& member) {
    return object({{"address", hex(member)}, {"digest", number(multicast::digest(member))}});
  });
  return object({{"version", number(wire::kVersion)},
                 {"team_key", hex(vector_team_key())},
                 {"session_key", hex(key)},
                 {"frames", lines(frame_vectors(), frame_text)},
                 {"images", lines(images(), image_text)},
                 {"digests", digests},
                 {"blocks", lines(std::vector<std::uint32_t>{30, 300, 8192, 8193, 20000}, blocks_text)},
                 {"erasure_code", parity_text()}},
                ",\n ") +
         "\n";
}

}  // namespace adhoc_communication
