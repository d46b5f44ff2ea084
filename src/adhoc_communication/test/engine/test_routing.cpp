// The rules of AODV, item by item (ids of the requirements list).
#include <gtest/gtest.h>

#include "routing/route_discovery.hpp"
#include "routing/route_table.hpp"
#include "routing/sequence_number.hpp"
#include "team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::routing {
namespace {

using namespace std::chrono_literals;

const Timings kTimings = robot_timings();
const MacAddress kD = {2, 0, 0, 0, 0, 9};
const MacAddress kX = {2, 0, 0, 0, 0, 1};
const MacAddress kY = {2, 0, 0, 0, 0, 2};

TEST(SequenceNumber, A2_2_ComparisonWraps) {
  EXPECT_TRUE(is_newer(1, 0));
  EXPECT_FALSE(is_newer(0, 0));
  EXPECT_TRUE(is_newer(0x7fffffff, 0));
  EXPECT_FALSE(is_newer(0x80000001, 0));
  EXPECT_TRUE(is_newer(0x10, 0xfffffff0));
  EXPECT_FALSE(is_newer(0xfffffff0, 0x10));
  EXPECT_EQ(newest(0xffffffff, 0), 0u);
}

RouteOffer offer(std::optional<std::uint32_t> sequence, std::uint8_t hops, const MacAddress& via = kX) {
  return {kD, 5, sequence, hops, static_cast<Cost>(hops * kPerfectHop), via, 10s};
}

TEST(RouteTable, A3_2_UpdatesOnlyNewerOrEqualAndShorter) {
  const auto changes = [](std::optional<std::uint32_t> sequence, std::uint8_t hops) {
    RouteTable table(kTimings);
    table.update(offer(100, 3));
    return table.update(offer(sequence, hops, kY));
  };
  EXPECT_FALSE(changes(99, 1));
  EXPECT_FALSE(changes(99, 3));
  EXPECT_TRUE(changes(100, 2));
  EXPECT_FALSE(changes(100, 3));
  EXPECT_FALSE(changes(100, 4));
  EXPECT_TRUE(changes(101, 9));
  EXPECT_FALSE(changes(std::nullopt, 1));
}

TEST(RouteTable, A2_6_A2_7_LinkLossRaisesNumberAndOnlyFreshNewsRevives) {
  RouteTable table(kTimings);
  table.update(offer(100, 3));
  const auto broken = table.break_link(kX, 1s);
  ASSERT_EQ(broken.size(), 1u);
  EXPECT_EQ(broken[0].sequence, 101u);
  EXPECT_EQ(table.usable(kD, 1s), nullptr);
  EXPECT_FALSE(table.update(offer(100, 1)));
  EXPECT_TRUE(table.update(offer(101, 7)));
  EXPECT_NE(table.usable(kD, 1s), nullptr);
}

TEST(RouteTable, A7_2_A7_6_ErrorCountsOnlyFromNextHopAndNeverLowersNumber) {
  RouteTable table(kTimings);
  table.update(offer(10, 3));
  wire::RouteError error;
  error.destinations = {{kD, 11}};
  EXPECT_TRUE(table.break_destinations(error, kY, 1s).empty());
  error.destinations = {{kD, 9}};
  EXPECT_TRUE(table.break_destinations(error, kX, 1s).empty());
  EXPECT_NE(table.usable(kD, 1s), nullptr);
  error.destinations = {{kD, 11}};
  EXPECT_EQ(table.break_destinations(error, kX, 1s).size(), 1u);
  EXPECT_EQ(table.find(kD)->sequence, 11u);
}

TEST(RouteTable, A7_7_A7_8_ExpiryInvalidatesKeepsThenDeletes) {
  RouteTable table(kTimings);
  table.update(offer(10, 3));
  table.expire(9999ms);
  EXPECT_NE(table.usable(kD, 9999ms), nullptr);
  table.expire(10s);
  ASSERT_NE(table.find(kD), nullptr);
  EXPECT_FALSE(table.find(kD)->valid);
  EXPECT_EQ(table.find(kD)->sequence, 11u);
  table.expire(10s + kTimings.delete_period - 1ms);
  EXPECT_NE(table.find(kD), nullptr);
  table.expire(10s + kTimings.delete_period);
  EXPECT_EQ(table.find(kD), nullptr);
}

TEST(RouteTable, A2_8_HeardNeighborHasNoValidNumber) {
  RouteTable table(kTimings);
  table.heard_directly(kX, 5, std::nullopt, kPerfectHop, 2s);
  EXPECT_FALSE(table.find(kX)->sequence_valid);
}

TEST(RouteTable, C3_SizeIsBounded) {
  RouteTable table(kTimings);
  for (int i = 0; i < 5000; ++i) {
    RouteOffer any = offer(1, 2);
    any.destination = {2, 1, 0, 0, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
    table.update(any);
  }
  EXPECT_EQ(table.size(), RouteTable::kMostRoutes);
}

std::vector<std::pair<Time, int>> requests(const EngineOptions& options, Time until, Time* failed = nullptr) {
  RouteDiscovery discovery(options);
  discovery.search({kD, "robot_9"}, 0, 0ms);
  std::vector<std::pair<Time, int>> sent;
  for (Time now = 0ms; now <= until; now += 1ms) {
    for (const auto& step : discovery.poll(now)) sent.emplace_back(now, step.hop_limit);
    for (const auto& failure : discovery.take_failures()) {
      if (failed != nullptr) *failed = failure.elapsed;
    }
  }
  return sent;
}

TEST(RouteDiscovery, A4_7_A12_2_BacksOffAndGivesUpWithinTwoSeconds) {
  Time failed = 0ms;
  const auto sent = requests({}, 3s, &failed);
  const std::vector<std::pair<Time, int>> expected = {{0ms, 35}, {120ms, 35}, {360ms, 35}, {840ms, 35}};
  EXPECT_EQ(sent, expected);
  EXPECT_EQ(failed, 1800ms);
}

TEST(RouteDiscovery, A4_5_A4_6_ExpandingRing) {
  EngineOptions options;
  options.hop_limit_min = 1;
  options.hop_limit_increment = 2;
  options.hop_limit_max = 5;
  const auto sent = requests(options, 3s);
  ASSERT_EQ(sent.size(), 6u);
  EXPECT_EQ(sent[0], std::pair(Time(0ms), 1));
  EXPECT_EQ(sent[1], std::pair(Time(30ms), 3));  // 2 * 5 ms * (1 + 2)
  EXPECT_EQ(sent[2], std::pair(Time(80ms), 5));  // 2 * 5 ms * (3 + 2)
  EXPECT_EQ(sent[5].second, 5);
}

TEST(RouteDiscovery, A4_9_RateIsLimited) {
  const EngineOptions options;
  RouteDiscovery discovery(options);
  for (std::uint8_t i = 0; i < 60; ++i) discovery.search({{2, 0, 0, 0, 1, i}, ""}, 0, 0ms);
  std::vector<Time> sent;
  for (Time now = 0ms; now < 20s; now += 1ms) {
    for (std::size_t n = discovery.poll(now).size(); n > 0; --n) sent.push_back(now);
  }
  for (std::size_t i = 10; i < sent.size(); ++i) EXPECT_GE(sent[i] - sent[i - 10], 1s);
}

TEST(Routing, A4_1_A4_2_A4_10_AbsentDestinationFailsWithReason) {
  Team team;
  team.add_line(3);
  team.run_for(1s);
  const SendId first = team.send(0, "robot_7", text("a"));
  const SendId second = team.send(0, "robot_7", text("b"), Priority::kBulk);
  const Time start = team.now();
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, first) && team.finished(0, second); }, 3s));
  EXPECT_EQ(team.finished(0, first)->reason, "no route to robot_7 after 1.8 s");
  EXPECT_FALSE(team.finished(0, second)->delivered);
  EXPECT_LE(team.now() - start, 2s);
}

TEST(Routing, A5_2_A5_8_EachRobotPassesARequestOnOnce) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  for (int i = 0; i < 5; ++i) team.add(options);
  team.run_for(1s);
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
    Team team(medium, seed);
    team.add({}, 0, 0);
    team.add({}, 7, 4);
    team.add({}, 7, -4);
    team.add({}, 14, 0);
    std::size_t relay = 0;
    team.on_transmission = [&](std::size_t robot, const Frame& frame) {
      if ((robot == 1 || robot == 2) && frame.bytes.size() > 1000) relay = robot;
    };
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
