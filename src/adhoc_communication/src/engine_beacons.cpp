// Presence: beacons, neighbours and robots that appear or fall silent.
#include <algorithm>

#include "engine_implementation.hpp"

namespace adhoc_communication {
namespace {

constexpr Time kLifeSignInterval = std::chrono::seconds(1);
constexpr std::size_t kBeaconFixedSize = 14 + 1 + wire::kLongestName + 6;
constexpr std::size_t kHeardSize = 7;
constexpr std::size_t kMostHeard = 24;  ///< in one beacon; with more, they take turns
constexpr std::size_t kRumorSize = 20 + wire::kLongestName;
constexpr std::size_t kMostRumors = 16;

}  // namespace

void Engine::Implementation::send_beacon(Time now) {
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

wire::Beacon Engine::Implementation::plain_beacon(Time now) const {
  wire::Beacon beacon;
  beacon.sequence_number = router_.own_sequence();
  beacon.alive = 1 + static_cast<std::uint32_t>((now - started_) / kLifeSignInterval);
  beacon.number = beacons_sent_;
  beacon.name = self_.name;
  return beacon;
}

/// Asks a neighbour that has become quiet for an acknowledgment: a few beacons may just have been lost.
void Engine::Implementation::probe(const MacAddress& neighbor, Time now) {
  if (!hops_.idle(neighbor)) return;
  wire::Beacon beacon = plain_beacon(now);
  beacon.heard.push_back({wire::neighbor_tag(neighbors_.find(neighbor)->boot), 0});
  hops_.unicast(neighbor, wire::FrameType::kBeacon, to_bytes(beacon));
}

void Engine::Implementation::on_beacon(const MacAddress& from, wire::BootTag boot, const wire::Beacon& beacon,
                                       Time now) {
  neighbors_.beacon(from, beacon, wire::neighbor_tag(self_.boot), now);
  directory_.life_sign(from, beacon.name, boot, beacon.alive, 1, now);
  if (neighbors_.two_way(from, now)) router_.on_hello(from, beacon.sequence_number, now);
  for (const wire::Rumor& rumor : beacon.rumors) {
    if (rumor.address == self_.address) continue;
    directory_.life_sign(rumor.address, rumor.name, rumor.boot, rumor.alive, static_cast<std::uint8_t>(rumor.hops + 1),
                         now);
  }
}

/// What has to be looked at a few times a second; rides on the beacons, so that an idle engine has one timer.
void Engine::Implementation::maintain(Time now) {
  for (const MacAddress& neighbor : neighbors_.newly_silent(now)) link_lost(neighbor, now);
  for (const MacAddress& neighbor : neighbors_.remove_silent(routing::RobotDirectory::kSilence, now)) {
    link_lost(neighbor, now);
    hops_.forget(neighbor);
  }
  hops_.maintain(now);
  air_.forget_unless([this](const MacAddress& neighbor) { return neighbors_.find(neighbor) != nullptr; });
  for (const MacAddress& neighbor : neighbors_.doubtful(now)) probe(neighbor, now);
  directory_.expire(now);
  runs_.expire(now);
  router_.expire(now);
  broadcast_receiver_.expire(now);
  receivers_.expire(now);
  expire_waiting_sends(now);
  distributor_.expire(now);
  memberships_.expire(now);
  carry_out_memberships(now);
}

void Engine::Implementation::announce_changes(Time now) {
  for (const std::string& name : directory_.take_taken_names()) report(NameTaken{name});
  for (const routing::DirectoryChange& change : directory_.take_changes()) {
    rhythm_.happened(now);
    if (change.appeared) {
      report(RobotAppeared{change.robot});
      if (own_group_.comes_back(change.robot, change.boot)) admit_member(change.robot, now);
      memberships_.appeared(change.robot);
      carry_out_memberships(now);
      continue;
    }
    report(RobotLost{change.robot});
    if (own_group_.lose(change.robot, change.boot)) leave_out(change.robot, change.robot + " was lost", now);
    memberships_.lost(change.robot);
  }
}

}  // namespace adhoc_communication
