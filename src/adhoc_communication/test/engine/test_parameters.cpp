// Parameters of the engine have their effect.
#include <gtest/gtest.h>

#include <set>

#include "team.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

int frames_in(Time duration, const EngineOptions& options) {
  Team team;
  team.add(options);
  int frames = 0;
  team.on_transmission = [&](std::size_t, const Frame&) { ++frames; };
  team.run_for(duration);
  return frames;
}

TEST(Parameters, BeaconIntervalSetsThePaceOfBeacons) {
  EngineOptions options;
  EXPECT_NEAR(frames_in(60s, options), 240, 24);
  options.beacon_interval = 100ms;
  EXPECT_NEAR(frames_in(60s, options), 600, 60);
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
  std::set<Time> times;
  team.on_transmission = [&](std::size_t robot, const Frame&) {
    if (robot == 0) times.insert(team.now());
  };
  const Time before = team.now();
  const SendId id = team.send(0, "robot_9", noise(10));
  team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s);
  const std::size_t beacons = static_cast<std::size_t>((team.now() - before) / options.beacon_interval);
  return times.size() - std::min(times.size(), beacons);
}

TEST(Parameters, MoreRouteRequestsWhereAsked) { EXPECT_GT(requests_for_nobody(5), requests_for_nobody(1) + 2); }

}  // namespace
}  // namespace adhoc_communication
