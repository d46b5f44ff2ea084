#include "host.hpp"

#include <algorithm>

#include "routing/living_runs.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

constexpr int kBeaconsToKnow = 40;  ///< until a link over which all are heard counts as perfect

}  // namespace

Host make_host(std::size_t number) {
  Host host;
  host.name = "host_" + std::to_string(number);
  host.address = {6, 6, 0, 0, static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)};
  host.boot_id = {0x77, static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)};
  return host;
}

EngineOptions without_groups(EngineOptions options) {
  options.join_groups_automatically = false;
  return options;
}

Stage::Stage(EngineOptions options) {
  team.add(without_groups(std::move(options)));
  team.on_transmission = [this](std::size_t, const Frame& frame) {
    frames_.emplace_back(team.now(), frame);
    answer(frame);
  };
}

Host Stage::self() const {
  Host self;
  self.name = Team::name(0);
  self.address = Team::address(0);
  self.boot_id = team.boot_id(0);
  return self;
}

Host& Stage::neighbor(std::size_t number, bool known) {
  const auto [found, added] = hosts_.emplace(number, make_host(number));
  for (int i = 0; added && known && i < kBeaconsToKnow; ++i) beacon(found->second);
  if (added && !known) found->second.beacons = false;
  return found->second;
}

void Stage::beacon(Host& host) {
  wire::Beacon beacon;
  beacon.sequence_number = host.sequence;
  beacon.alive = 1 + static_cast<std::uint32_t>(now() / std::chrono::seconds(1));
  beacon.number = ++host.beacons_said;
  beacon.name = host.name;
  beacon.heard_count = 1;
  beacon.heard.push_back({wire::neighbor_tag(self().boot()), 0});
  beacon.interval_ms = host.announced_interval_ms;
  say(host, beacon);
}

void Stage::restart(Host& host) {
  host.boot_id[0] ^= 1;
  const Time end = now() + routing::LivingRuns::kUnheard + std::chrono::milliseconds(50);
  while (now() < end) {
    beacon(host);
    run_for(std::chrono::milliseconds(10));
  }
}

void Stage::acknowledge(Host& host) {
  wire::HopAcknowledgment acknowledgment;
  acknowledgment.boot = self().boot();
  say(host, acknowledgment, self().address);
}

void Stage::give_route(Host& via, const Host& destination, int hops, Time lifetime) {
  wire::RouteReply reply = reply_about(destination, self());
  reply.hop_count = static_cast<std::uint8_t>(hops - 1);
  reply.cost = static_cast<std::uint16_t>(16 * (hops - 1));
  reply.lifetime_ms = static_cast<std::uint32_t>(lifetime / std::chrono::milliseconds(1));
  say(via, reply, self().address);
}

void Stage::say_octets(Host& host, wire::FrameType type, const Bytes& body, const MacAddress& to) {
  wire::FrameHeader header;
  header.type = type;
  header.sender = host.address;
  header.boot_id = host.boot_id;
  header.counter = ++host.counter;
  header.next_hop = to;
  node().receive({to, host.address, wire::close_openly(header, body)}, now());
}

void Stage::run_for(Time duration) {
  const Time end = now() + duration;
  while (now() < end) {
    team.run_for(std::min(end, beacons_due_) - now());
    if (now() < beacons_due_) continue;
    for (auto& [number, host] : hosts_) {
      if (host.beacons) beacon(host);
    }
    beacons_due_ += kInterval;
  }
}

void Stage::answer(const Frame& frame) {
  wire::Reader reader(frame.bytes);
  const wire::FrameHeader header = wire::read_header(reader).value();
  if ((header.flags & wire::kWantsAcknowledgment) == 0) return;
  for (auto& [number, host] : hosts_) {
    if (host.address != header.next_hop || !host.acknowledges) continue;
    wire::HopAcknowledgment acknowledgment;
    acknowledgment.boot = self().boot();
    acknowledgment.newest_counter = header.counter;
    acknowledgment.highest = header.link_sequence;
    acknowledgment.received = 1;
    say(host, acknowledgment, self().address);
  }
}

std::vector<Sent<wire::RouteRequest>> Stage::requests() const {
  std::vector<Sent<wire::RouteRequest>> result = sent<wire::RouteRequest>();
  const auto is_copy = [](const auto& request) { return request.to != wire::kEverybody; };
  result.erase(std::remove_if(result.begin(), result.end(), is_copy), result.end());
  return result;
}

std::size_t Stage::count(wire::FrameType type) const {
  return static_cast<std::size_t>(std::count_if(frames_.begin(), frames_.end(), [type](const auto& item) {
    return item.second.bytes[1] == static_cast<std::uint8_t>(type);
  }));
}

std::optional<RouteState> Stage::entry(const Host& destination) {
  for (const RouteState& route : node().routes()) {
    if (route.destination == destination.address) return route;
  }
  return std::nullopt;
}

std::optional<RouteState> Stage::route(const Host& destination) {
  const std::optional<RouteState> found = entry(destination);
  return found && found->valid && found->expires > now() ? found : std::nullopt;
}

wire::RouteRequest request_for(const Host& destination, const Host& originator, std::uint32_t id) {
  wire::RouteRequest request;
  request.unknown_sequence_number = true;
  request.hop_limit = 9;
  request.id = id;
  request.destination = destination.address;
  request.destination_name = destination.name;
  request.originator = originator.address;
  request.originator_sequence = originator.sequence;
  request.originator_boot = originator.boot();
  request.originator_name = originator.name;
  return request;
}

wire::RouteReply reply_about(const Host& destination, const Host& originator) {
  wire::RouteReply reply;
  reply.destination = destination.address;
  reply.destination_sequence = destination.sequence;
  reply.destination_boot = destination.boot();
  reply.destination_name = destination.name;
  reply.originator = originator.address;
  reply.lifetime_ms = 10'000;
  return reply;
}

wire::TransportAcknowledgment acknowledgment_of(const Host& from, const Host& to, std::uint32_t next) {
  wire::TransportAcknowledgment acknowledgment;
  acknowledgment.source = from.address;
  acknowledgment.source_boot = from.boot();
  acknowledgment.destination = to.address;
  acknowledgment.destination_boot = to.boot();
  acknowledgment.next = next;
  return acknowledgment;
}

wire::RouteError error_about(const std::vector<std::pair<Host, std::uint32_t>>& lost) {
  wire::RouteError error;
  for (const auto& [host, number] : lost) error.destinations.push_back({host.address, number});
  return error;
}

wire::Data data_for(const Host& destination, const Host& source, std::uint32_t packet) {
  const transport::Image image =
      transport::encode({transport::PacketKind::kUser, 'A', {}, "topic", text(std::to_string(packet))});
  wire::Data data;
  data.source = source.address;
  data.source_boot = source.boot();
  data.destination = destination.address;
  data.stream = static_cast<std::uint8_t>(Priority::kNormal);
  data.packet = packet;
  data.base = 1;
  data.total = static_cast<std::uint32_t>(image->size());
  data.segment_size = 1000;
  data.octets = *image;
  return data;
}

}  // namespace adhoc_communication
