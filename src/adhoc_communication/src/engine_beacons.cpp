// Presence: beacons, neighbours and robots that appear or fall silent.
#include <algorithm>

#include "engine_implementation.hpp"

namespace adhoc_communication {
namespace {

constexpr Time kLifeSignInterval = std::chrono::seconds(1);
constexpr std::size_t kBeaconFixedSize = 10 + 1 + wire::kLongestName;
constexpr std::size_t kHeardSize = 14;
constexpr std::size_t kRumorSize = 20 + wire::kLongestName;
constexpr std::size_t kMostRumors = 16;

}  // namespace

void Engine::Implementation::send_beacon(Time now) {
  const std::size_t room =
      static_cast<std::size_t>(std::min(options_.mtu, 1500)) - wire::kHeaderSize - wire::kTagSize - kBeaconFixedSize;
  wire::Beacon beacon;
  beacon.sequence_number = router_.own_sequence();
  beacon.alive = 1 + static_cast<std::uint32_t>((now - started_) / kLifeSignInterval);
  beacon.name = self_.name;
  beacon.heard = neighbors_.heard_list(room * 2 / 3 / kHeardSize, now);
  const std::size_t rumors = std::min(kMostRumors, (room - beacon.heard.size() * kHeardSize) / kRumorSize);
  beacon.rumors =
      directory_.take_rumors(rumors, [&](const MacAddress& robot) { return !neighbors_.all_hear(robot, now); });
  broadcast(wire::FrameType::kBeacon, to_bytes(beacon));
  last_beacon_ = now;
  // A tenth of randomness keeps the beacons of robots started together from meeting again and again.
  const Time interval = options_.beacon_interval;
  beacon_due_ = now + interval * 19 / 20 + random_.delay(interval / 10);
}

void Engine::Implementation::on_beacon(const MacAddress& from, wire::BootTag boot, const wire::Beacon& beacon,
                                       Time now) {
  neighbors_.beacon(from, beacon, {self_.address, self_.boot}, now);
  directory_.life_sign(from, beacon.name, boot, beacon.alive, 1, now);
  if (neighbors_.two_way(from, now)) router_.on_hello(from, boot, beacon.sequence_number, now);
  for (const wire::Rumor& rumor : beacon.rumors) {
    if (rumor.address == self_.address) continue;
    directory_.life_sign(rumor.address, rumor.name, rumor.boot, rumor.alive, static_cast<std::uint8_t>(rumor.hops + 1),
                         now);
  }
}

/// What has to be looked at a few times a second; rides on the beacons, so that an idle engine has one timer.
void Engine::Implementation::maintain(Time now) {
  for (const MacAddress& neighbor : neighbors_.newly_silent(now)) router_.link_broken(neighbor, now);
  for (const MacAddress& neighbor : neighbors_.remove_silent(routing::RobotDirectory::kSilence, now)) {
    link_lost(neighbor, now);
    links_.erase(neighbor);
  }
  for (auto& [neighbor, link] : links_) neighbors_.set_loss(neighbor, link.sender.loss());
  directory_.expire(now);
  router_.expire(now);
  broadcast_receiver_.expire(now);
  for (auto& [source, receiver] : receivers_) receiver->expire(now);
  expire_waiting_sends(now);
  distributor_.expire(now);
  join_due_groups(now);
}

void Engine::Implementation::announce_changes(Time now) {
  for (const routing::DirectoryChange& change : directory_.take_changes()) {
    const std::string group = multicast::group_of(change.robot);
    if (change.appeared) {
      report(RobotAppeared{change.robot});
      if (options_.join_groups_automatically) start_join(group, now);
      continue;
    }
    report(RobotLost{change.robot});
    remove_member(change.robot, change.robot + " was lost", now);
    const auto membership = groups_.memberships.find(group);
    if (membership != groups_.memberships.end()) membership->second.joined = false;
  }
}

/// Frames to the neighbour go unanswered, it fell silent, or it has restarted.
void Engine::Implementation::link_lost(const MacAddress& neighbor, Time now) {
  if (const auto found = links_.find(neighbor); found != links_.end()) found->second.sender.clear();
  router_.link_broken(neighbor, now);
  distributor_.link_lost(neighbor, now);
}

}  // namespace adhoc_communication
