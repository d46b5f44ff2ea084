#include "presence/presence.hpp"

#include <algorithm>

namespace adhoc_communication::presence {
namespace {

constexpr Time kLifeSignInterval = std::chrono::seconds(1);
constexpr std::size_t kBeaconFixedSize = 14 + 1 + wire::kLongestName + 6;
constexpr std::size_t kHeardSize = 7;
constexpr std::size_t kMostHeard = 24;  ///< in one beacon; with more, they take turns
constexpr std::size_t kRumorSize = 20 + wire::kLongestName;
constexpr std::size_t kMostRumors = 16;

}  // namespace

void Presence::send_beacon(Time now) {
  const std::size_t room =
      static_cast<std::size_t>(std::min(options_.mtu, 1500)) - wire::kHeaderSize - wire::kTagSize - kBeaconFixedSize;
  const Time interval = rhythm_.next(now);
  wire::Beacon beacon = plain_beacon(now);
  beacon.number = ++beacons_sent_;
  beacon.interval_ms = static_cast<std::uint32_t>(interval / std::chrono::milliseconds(1));
  beacon.heard_count = static_cast<std::uint16_t>(neighbors_.heard_count(now));
  beacon.heard = neighbors_.next_heard(kMostHeard, now);
  const std::size_t rumors = std::min(kMostRumors, (room - beacon.heard.size() * kHeardSize) / kRumorSize);
  beacon.rumors = directory_.take_rumors(
      rumors, [&](const MacAddress& robot, wire::BootTag boot) { return !neighbors_.all_hear(robot, boot, now); });
  hops_.broadcast(wire::FrameType::kBeacon, to_bytes(beacon), now);
}

wire::Beacon Presence::plain_beacon(Time now) const {
  wire::Beacon beacon;
  beacon.sequence_number = router_.own_sequence();
  beacon.alive = 1 + static_cast<std::uint32_t>((now - started_) / kLifeSignInterval);
  beacon.number = beacons_sent_;
  beacon.name = self_.name;
  return beacon;
}

/// Most neighbours that fall silent while others still tell of them have driven away: data for them finds out soon
/// enough.
void Presence::probe_doubtful(Time now) {
  for (const MacAddress& neighbor : neighbors_.doubtful(now)) {
    const Time last_heard = neighbors_.find(neighbor)->last_heard;
    const bool is_elsewhere = neighbors_.silent(neighbor, now) && directory_.has_news_since(neighbor, last_heard);
    if (!is_elsewhere) ask(neighbor, now);
  }
}

void Presence::ask(const MacAddress& neighbor, Time now) {
  const routing::Neighbor* known = neighbors_.find(neighbor);
  if (known == nullptr || !hops_.idle(neighbor)) return;
  wire::Beacon beacon = plain_beacon(now);
  beacon.heard.push_back({wire::neighbor_tag(known->boot), 0});
  hops_.unicast(neighbor, wire::FrameType::kBeacon, to_bytes(beacon));
}

void Presence::ask_in_doubt(const MacAddress& neighbor, Time now) {
  if (runs_.wants_answer(neighbor, neighbors_.two_way(neighbor, now), now)) ask(neighbor, now);
}

void Presence::on_beacon(const MacAddress& from, wire::BootTag boot, const wire::Beacon& beacon, Time now) {
  neighbors_.beacon(from, beacon, wire::neighbor_tag(self_.boot), now);
  const bool good = neighbors_.two_way(from, now) && neighbors_.loss(from) <= routing::Neighbors::kBadLoss;
  directory_.life_sign(from, beacon.name, boot, beacon.alive, 1, from, good, now);
  if (neighbors_.two_way(from, now)) router_.on_hello(from, beacon.sequence_number, now);
  for (const wire::Rumor& rumor : beacon.rumors) {
    if (rumor.address == self_.address) continue;
    directory_.life_sign(rumor.address, rumor.name, rumor.boot, rumor.alive, static_cast<std::uint8_t>(rumor.hops + 1),
                         from, good, now);
  }
}

}  // namespace adhoc_communication::presence
