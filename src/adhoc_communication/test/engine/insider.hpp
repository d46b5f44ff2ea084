// Somebody who is nobody of a team and knows its protocol; of a sealed team, its key, too.
#pragma once

#include <utility>
#include <vector>

#include "host.hpp"
#include "security/frame_guard.hpp"

namespace adhoc_communication {

class Insider {
 public:
  Insider(Team& team, const Host& host, std::vector<TeamKey> keys)
      : team_(team),
        host_(host),
        self_{host.name, host.address, host.boot_id, host.boot()},
        guard_(self_, std::move(keys), dropped_) {}

  const Host& host() const { return host_; }
  Host robot(std::size_t number) const {
    Host robot;
    robot.name = Team::name(number);
    robot.address = Team::address(number);
    robot.boot_id = team_.boot_id(number);
    return robot;
  }
  void say(std::size_t robot, wire::FrameType type, const Bytes& body) {
    wire::FrameHeader header;
    header.type = type;
    header.sender = host_.address;
    header.boot_id = host_.boot_id;
    header.counter = ++counter_;
    header.next_hop = wire::kEverybody;
    team_.engine(robot).receive({wire::kEverybody, host_.address, guard_.close(header, body)}, team_.now());
  }
  /// Something to that robot alone which it owes an acknowledgment for, at once.
  void demand_acknowledgment(std::size_t robot) {
    wire::FrameHeader header;
    header.type = wire::FrameType::kRouteReplyAcknowledgment;
    header.flags = wire::kWantsAcknowledgment | wire::kAcknowledgeNow;
    header.sender = host_.address;
    header.boot_id = host_.boot_id;
    header.counter = ++counter_;
    header.next_hop = Team::address(robot);
    header.link_sequence = ++link_sequence_;
    team_.engine(robot).receive({header.next_hop, host_.address, guard_.close(header, {})}, team_.now());
  }
  template <typename Message>
  void say(std::size_t robot, const Message& message) {
    say(robot, Kind<Message>::kType, wire::to_bytes(message));
  }
  /// A beacon that names the robot's present run, as only who hears it can.
  void prove(std::size_t robot, std::vector<wire::Rumor> rumors = {}) {
    wire::Beacon beacon;
    beacon.name = host_.name;
    beacon.alive = 1 + static_cast<std::uint32_t>(team_.now() / std::chrono::seconds(1));
    beacon.number = ++number_;
    beacon.heard_count = 1;
    beacon.heard.push_back({wire::neighbor_tag(wire::boot_tag(team_.boot_id(robot))), 0});
    beacon.rumors = std::move(rumors);
    say(robot, beacon);
  }

 private:
  Team& team_;
  Host host_;
  Identity self_;
  FramesDropped dropped_;
  security::FrameGuard guard_;
  std::uint64_t counter_ = 0;
  std::uint32_t link_sequence_ = 0;
  std::uint16_t number_ = 0;
};

}  // namespace adhoc_communication
