// Routing of whole teams. The rules of AODV one by one: test_aodv_*.cpp.
#include <gtest/gtest.h>

#include "diamond.hpp"
#include "payloads.hpp"
#include "routing/route_table.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::routing {
namespace {

using namespace std::chrono_literals;

TEST(RouteTable, SizeIsBounded) {
  const Timings timings = robot_timings();
  RouteTable table(timings);
  for (int i = 0; i < 5000; ++i) {
    const MacAddress destination = {2, 1, 0, 0, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
    table.update({destination, 5, 1, 2, 2 * kPerfectHop, {2, 0, 0, 0, 0, 1}, 10s});
  }
  EXPECT_EQ(table.size(), RouteTable::kMostRoutes);
}

TEST(Routing, A5_2_A5_8_EachRobotPassesARequestOnOnce) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add_line(5, options);
  team.run_for(10s);  // until all know their links
  std::map<std::pair<std::size_t, std::uint32_t>, int> broadcasts;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (frame.bytes[1] == 2 && frame.destination == wire::kEverybody)
      ++broadcasts[{robot, frame.bytes[wire::kHeaderSize + 8]}];
  };
  team.send(0, "robot_9", text("x"));
  team.run_for(2s);
  EXPECT_EQ(broadcasts.size(), 20u);  // 4 requests, 5 robots
  for (const auto& [key, count] : broadcasts) EXPECT_EQ(count, 1);
}

TEST(Routing, A13_1_NextHopsNeverLeadBackUnderChurn) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    MediumOptions medium;
    medium.loss = 0.2;
    Team team(medium, seed);
    Random random(seed);
    for (int i = 0; i < 9; ++i) team.add({}, random.uniform() * 22, random.uniform() * 22);
    for (int step = 0; step < 120; ++step) {
      const std::size_t moved = random.next() % 9;
      team.medium().set_position(moved, random.uniform() * 22, random.uniform() * 22);
      team.send(random.next() % 9, Team::name(random.next() % 9), noise(random.next() % 4000));
      team.run_for(Time(100ms) + random.delay(200ms));
      for (std::size_t destination = 0; destination < 9; ++destination) {
        std::map<std::size_t, std::size_t> next;
        for (std::size_t robot = 0; robot < 9; ++robot) {
          for (const RouteState& route : team.engine(robot).routes()) {
            if (route.valid && route.expires > team.now() && route.destination == Team::address(destination))
              next[robot] = route.next_hop[5];
          }
        }
        for (std::size_t robot = 0; robot < 9; ++robot) {
          std::size_t at = robot;
          int hops = 0;
          while (at != destination && next.count(at) != 0 && hops <= 9) at = next[at], ++hops;
          ASSERT_LE(hops, 9) << "loop towards robot_" << destination << ", seed " << seed << ", step " << step;
        }
      }
    }
  }
}

TEST(Routing, RelayDiesAndTrafficFlowsAgainWithinASecond) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    MediumOptions medium;
    medium.loss = seed % 2 == 0 ? 0.1 : 0.0;
    Diamond diamond(medium, seed);
    Team& team = diamond.team;
    const std::size_t& relay = diamond.relay;
    team.run_for(1s);
    const SendId before = team.send(0, "robot_3", noise(2000));
    ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, before) != nullptr; }, 5s));
    ASSERT_NE(relay, 0u);
    team.kill(relay);
    const Time killed = team.now();
    const SendId after = team.send(0, "robot_3", noise(2000));
    ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, after) != nullptr; }, 5s)) << "seed " << seed;
    EXPECT_TRUE(team.finished(0, after)->delivered);
    EXPECT_LE(team.now() - killed, 1s) << "seed " << seed;
  }
}

}  // namespace
}  // namespace adhoc_communication::routing
