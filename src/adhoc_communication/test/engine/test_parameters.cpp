// Parameters of the engine have their effect.
#include <gtest/gtest.h>

#include "payloads.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

bool is_of_type(const Frame& frame, wire::FrameType type) { return frame.bytes[1] == static_cast<std::uint8_t>(type); }

/// Beacons of a robot in a minute, once it has settled; with traffic, something happens twice a second.
int beacons_in_a_minute(int interval_ms, bool traffic) {
  EngineOptions options;
  options.beacon_interval = std::chrono::milliseconds(interval_ms);
  Team team;
  team.add(options);
  team.add(options);
  team.run_for(10s);
  int beacons = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (robot == 0 && is_of_type(frame, wire::FrameType::kBeacon)) ++beacons;
  };
  for (int i = 0; i < 120; ++i) {
    if (traffic) team.send(0, "robot_1", noise(100));
    team.run_for(500ms);
  }
  return beacons;
}

TEST(Parameters, BeaconIntervalSetsThePaceOfBeacons) {
  EXPECT_NEAR(beacons_in_a_minute(250, true), 240, 24);
  EXPECT_NEAR(beacons_in_a_minute(100, true), 600, 60);
}

TEST(Parameters, BeaconsBackOffToASecondWhileNothingHappens) {
  EXPECT_NEAR(beacons_in_a_minute(250, false), 60, 6);
  EXPECT_NEAR(beacons_in_a_minute(100, false), 60, 6);
  EXPECT_NEAR(beacons_in_a_minute(1200, false), 50, 5);
}

// Small packets, one after the other, on a link that loses much and repeats nothing itself.
int delivered_of_twenty(int num_e2e_retrans) {
  EngineOptions options;
  options.num_link_retrans = 0;
  options.num_e2e_retrans = num_e2e_retrans;
  MediumOptions medium;
  medium.loss = 0.4;
  Team team(medium);
  team.add_line(2, options);
  team.run_for(3s);
  int delivered = 0;
  for (int i = 0; i < 20; ++i) {
    const SendId id = team.send(0, "robot_1", noise(100));
    team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s);
    delivered += team.finished(0, id) != nullptr && team.finished(0, id)->delivered;
  }
  return delivered;
}

TEST(Parameters, ResendsFromEndToEndBringPacketsThrough) {
  EXPECT_LT(delivered_of_twenty(0), 20);
  EXPECT_EQ(delivered_of_twenty(20), 20);
}

// Route requests for a robot that nobody knows, at one and the same hop limit.
std::size_t requests_for_nobody(int num_rreq) {
  EngineOptions options;
  options.num_rreq = num_rreq;
  options.hop_limit_min = 1;
  options.hop_limit_max = 1;
  Team team;
  team.add(options);
  team.add(options);
  team.run_for(2s);
  std::size_t requests = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (robot == 0 && frame.destination == wire::kEverybody && is_of_type(frame, wire::FrameType::kRouteRequest)) {
      ++requests;
    }
  };
  const SendId id = team.send(0, "robot_9", noise(10));
  team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s);
  return requests;
}

TEST(Parameters, MoreRouteRequestsWhereAsked) { EXPECT_EQ(requests_for_nobody(5), requests_for_nobody(1) + 4); }

}  // namespace
}  // namespace adhoc_communication
