// The first request of a search goes from robot to robot, the way that life signs came.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "routing/request_load.hpp"
#include "routing/route_discovery.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

/// Requests that the robots have put on the air.
struct Requests {
  explicit Requests(Team& team) {
    team.on_transmission = [this](std::size_t, const Frame& frame) {
      wire::Reader reader(frame.bytes);
      const auto header = wire::read_header(reader);
      if (!header || header->type != wire::FrameType::kRouteRequest) return;
      (header->next_hop == wire::kEverybody ? flooded : directed) += 1;
    };
  }
  int flooded = 0;
  int directed = 0;
};

bool delivered(Team& team, std::size_t from, const std::string& to) {
  const SendId id = team.send(from, to, text("x"));
  team.run_until_done([&] { return team.finished(from, id) != nullptr; }, 10s);
  return team.finished(from, id) != nullptr && team.finished(from, id)->delivered;
}

TEST(DirectedRequests, A4_15_AFarRobotThatLivesIsFoundWithoutAFlood) {
  Team team;
  for (int column = 0; column < 6; ++column) {
    for (int row = 0; row < 3; ++row) team.add(without_groups(), 8.0 * column, 4.0 * row);
  }
  team.run_for(6s);
  Requests requests(team);
  ASSERT_TRUE(delivered(team, 0, "robot_16"));
  EXPECT_EQ(requests.flooded, 0);
  EXPECT_LE(requests.directed, 8) << "five hops, and those who ask back";
}

TEST(DirectedRequests, WhereTheWayHasEndedTheNextRequestIsFlooded) {
  Team team;
  team.add_line(5, without_groups());
  for (int i = 0; i < 5; ++i) team.add(without_groups(), 8.0 * i, i == 0 || i == 4 ? 4.0 : 9.0);  // another way
  team.run_for(6s);
  for (const std::size_t relay : {2, 7}) {
    Requests requests(team);
    team.kill(relay);
    EXPECT_TRUE(delivered(team, 0, "robot_4")) << relay;
    team.restart(relay);
    team.run_for(20s);  // the route is forgotten, the ways are told of anew
  }
}

/// In a full channel a search that failed ended the send, to a robot whose life signs kept coming.
TEST(DirectedRequests, ASearchForARobotThatLivesGoesOn) {
  const EngineOptions options;
  for (const std::uint8_t told : {std::uint8_t{0}, std::uint8_t{3}}) {
    Random random(1);
    routing::RouteDiscovery discovery(options, random);
    discovery.search({Team::address(7), {}}, 0, 0, 0s);
    int floods = 0, directed = 0;
    std::vector<routing::DiscoveryFailure> failures;
    for (Time now = 0s; failures.empty() && now < 60s; now += 10ms) {
      for (const auto& step : discovery.poll([&](const routing::Target&) { return told; }, now)) {
        ++(step.directed ? directed : floods);
      }
      failures = discovery.take_failures();
    }
    ASSERT_EQ(failures.size(), 1u);
    EXPECT_EQ(failures[0].elapsed >= routing::RouteDiscovery::kPatience, told > 0);
    EXPECT_EQ(directed > 0, told > 0);
    EXPECT_EQ(floods, options.num_rreq + options.timings.request_retries) << "no more of these";
  }
}

/// The way that life signs come may end at a link that carries none, where directed requests ended for ten seconds.
TEST(DirectedRequests, ASearchForARobotThatIsPresentFloodsInBetween) {
  Random random(1);
  routing::RouteDiscovery discovery({}, random);
  discovery.search({Team::address(7), {}}, 0, 0, 0s);
  std::string steps;
  for (Time now = 0s; discovery.searches() > 0 && now < 60s; now += 10ms) {
    const auto told = [](const routing::Target&) { return std::uint8_t{3}; };
    const auto present = [](const routing::Target&) { return true; };
    for (const auto& step : discovery.poll(told, now, present)) steps += step.directed ? 'd' : 'f';
  }
  EXPECT_EQ(steps.find("ffffd"), 0u) << steps;
  EXPECT_GE(steps.size(), 16u) << steps;
  EXPECT_EQ(steps.find("dd"), std::string::npos) << steps;
  EXPECT_EQ(steps.find("ff", 4), std::string::npos) << steps;
}

/// Packets of sources that nobody knows took all of the room for searches, and all requests.
TEST(RouteDiscovery, WhatOthersCauseLeavesRoomAndRequests) {
  const EngineOptions options;
  Random random(1);
  routing::RouteDiscovery discovery(options, random);
  const auto untold = [](const routing::Target&) { return std::uint8_t{0}; };
  std::size_t begun = 0;
  for (std::size_t i = 0; i < 64; ++i)
    begun += discovery.search_for_others({make_host(i).address, {}}, 0, 0, 0s) ? 1 : 0;
  EXPECT_EQ(begun, routing::RouteDiscovery::kMostForOthers);
  EXPECT_FALSE(discovery.repair(Team::address(1), 3, 0s));
  EXPECT_TRUE(discovery.take_failures().empty());
  const std::size_t limit = static_cast<std::size_t>(options.timings.request_rate_limit);
  EXPECT_EQ(discovery.poll(untold, 0s).size(), limit / 2);
  for (std::size_t i = 0; i < limit / 2; ++i) discovery.search({make_host(100 + i).address, {}}, 0, 0, 1ms);
  EXPECT_EQ(discovery.poll(untold, 1ms).size(), limit - limit / 2) << "the other half is for own packets";
  discovery.search({make_host(0).address, {}}, 0, 0, 1ms);
  EXPECT_EQ(discovery.searches_for_others(), routing::RouteDiscovery::kMostForOthers - 1) << "it is an own one now";
  for (std::size_t i = 200; i < 300; ++i) discovery.search({make_host(i).address, {}}, 0, 0, 1ms);
  EXPECT_EQ(discovery.searches(), routing::RouteDiscovery::kMostSearches);
}

/// Hops that repeat the request or the answer make it slow, and a flood would only be in their way.
TEST(DirectedRequests, TheFloodWaitsForAnswersThatHopsHaveToRepeat) {
  const EngineOptions options;
  Random random(1);
  routing::RouteDiscovery discovery(options, random);
  constexpr std::uint8_t kTold = 4;
  const auto untold = [](const routing::Target&) { return std::uint8_t{0}; };
  discovery.search({Team::address(7), {}}, 0, kTold, 0s);
  const auto first = discovery.poll(untold, 0s);
  ASSERT_EQ(first.size(), 1u);
  EXPECT_TRUE(first.front().directed);
  const Time wait = routing::RouteDiscovery::kDirectedPatience *
                    options.timings.ring_traversal_time(kTold + routing::RouteDiscovery::kDetour);
  EXPECT_GE(wait, 2 * options.timings.ring_traversal_time(kTold + routing::RouteDiscovery::kDetour));
  EXPECT_EQ(discovery.next_deadline(), wait);
  EXPECT_TRUE(discovery.poll(untold, wait - 1ms).empty());
  const auto second = discovery.poll(untold, wait);
  ASSERT_EQ(second.size(), 1u);
  EXPECT_FALSE(second.front().directed);
}

TEST(DirectedRequests, A4_15_WithTheConstantsOfTheRfcThereAreNone) {
  EngineOptions options = without_groups();
  options.timings = rfc3561_timings();
  Team team;
  team.add_line(5, options);
  team.run_for(6s);
  Requests requests(team);
  ASSERT_TRUE(delivered(team, 0, "robot_4"));
  EXPECT_GE(requests.flooded, 4);
}

TEST(DirectedRequests, OneThatCannotGoOnIsPassedToNobody) {
  Stage stage;
  Host& neighbor = stage.neighbor(1);
  stage.neighbor(2);
  stage.run_for(1s);
  stage.forget();
  wire::RouteRequest request = request_for(make_host(100), make_host(101));
  request.directed = true;
  request.hop_limit = 5;
  stage.say(neighbor, request, stage.self().address);
  stage.run_for(200ms);
  EXPECT_EQ(stage.count(wire::FrameType::kRouteRequest), 0u);
  EXPECT_TRUE(stage.route(make_host(101))) << "the way back is known all the same";
}

/// What the node sends on of a directed request for a neighbour that gets a tenth of its frames; `way_round`: and gets
/// those of a third robot, which hears the node.
std::vector<Sent<wire::RouteRequest>> passed_to_lossy_neighbor(bool way_round) {
  Stage stage;
  Host& from = stage.neighbor(1);
  Host& lossy = stage.neighbor(2, false);
  lossy.beacons = false;
  const Host& third = stage.neighbor(3);
  wire::Beacon beacon;
  beacon.name = lossy.name;
  beacon.heard = {{wire::neighbor_tag(stage.self().boot()), 230}};
  if (way_round) beacon.heard.push_back({wire::neighbor_tag(third.boot()), 0});
  beacon.heard_count = static_cast<std::uint16_t>(beacon.heard.size());
  for (beacon.alive = beacon.number = 1; beacon.number <= 10; ++beacon.alive, ++beacon.number) {
    stage.say(lossy, beacon);
    stage.run_for(Stage::kInterval);
  }
  EXPECT_FALSE(stage.route(lossy)) << "requests decide";
  stage.forget();
  wire::RouteRequest request = request_for(lossy, make_host(101));
  request.directed = request.destination_only = true;
  request.hop_limit = 5;
  stage.say(from, request, stage.self().address);
  stage.run_for(50ms);
  return stage.sent<wire::RouteRequest>();
}

/// Searches died for ten seconds before a robot that its neighbour heard all the time, over a link without a route.
TEST(DirectedRequests, ANeighborBehindALossyLinkIsAskedItself) {
  const auto passed = passed_to_lossy_neighbor(false);
  ASSERT_FALSE(passed.empty());
  EXPECT_EQ(passed[0].to, make_host(2).address);
  EXPECT_TRUE(passed_to_lossy_neighbor(true).empty()) << "the flood finds the way over the third robot";
}

TEST(DirectedRequests, OneThatComesFromWhereItWouldGoIsPassedToNobody) {
  Stage stage;
  Host& neighbor = stage.neighbor(1);
  stage.run_for(1s);
  stage.give_route(neighbor, make_host(100));
  stage.forget();
  wire::RouteRequest request = request_for(make_host(100), make_host(101));
  request.directed = request.destination_only = true;
  request.hop_limit = 5;
  stage.say(neighbor, request, stage.self().address);
  stage.run_for(1s);
  EXPECT_EQ(stage.count(wire::FrameType::kRouteRequest), 0u);
}

TEST(RequestLoad, IsHeavyWhileRequestsComeThickAndFast) {
  routing::RequestLoad load;
  const Time gap = routing::RequestLoad::kWindow / (2 * static_cast<int>(routing::RequestLoad::kHeavy));
  Time now = 10s;
  for (std::size_t i = 1; i < routing::RequestLoad::kHeavy; ++i) load.heard(now += gap);
  EXPECT_FALSE(load.heavy(now));
  load.heard(now += gap);
  EXPECT_TRUE(load.heavy(now));
  EXPECT_FALSE(load.heavy(now + routing::RequestLoad::kWindow));
  for (int i = 0; i < 1000; ++i) load.heard(now += 3 * gap);
  EXPECT_FALSE(load.heavy(now));
  EXPECT_FALSE(load.full(now));
}

TEST(RequestLoad, IsFullWithTwiceAsMany) {
  routing::RequestLoad load;
  for (std::size_t i = 1; i < routing::RequestLoad::kFull; ++i) load.heard(1s);
  EXPECT_TRUE(load.heavy(1s));
  EXPECT_FALSE(load.full(1s));
  load.heard(1s);
  EXPECT_TRUE(load.full(1s));
  EXPECT_FALSE(load.full(1s + routing::RequestLoad::kWindow));
}

/// What the node does with a request of which several neighbours have none, after so many others.
std::size_t frames_for_one(std::size_t others) {
  Stage stage(without_groups());
  for (std::size_t i = 1; i <= 4; ++i) stage.neighbor(i);
  stage.run_for(1s);
  Host& neighbor = stage.neighbor(1);
  for (std::uint32_t i = 0; i < others; ++i) {
    wire::RouteRequest request = request_for(make_host(100), make_host(101), 1000 + i);
    request.hop_limit = 1;
    stage.say(neighbor, request);
  }
  stage.forget();
  wire::RouteRequest request = request_for(make_host(100), make_host(101));
  request.hop_limit = 5;
  stage.say(neighbor, request);
  stage.run_for(200ms);
  return stage.count(wire::FrameType::kRouteRequest);
}

TEST(RequestLoad, WhileItIsHeavyNobodyGetsACopyOfHisOwn) {
  EXPECT_GT(frames_for_one(0), 1u);
  EXPECT_EQ(frames_for_one(routing::RequestLoad::kHeavy), 1u);
}

/// Floods to join every group of everybody took all the air there was: in 10 s not one packet arrived.
TEST(RequestLoad, ACrowdThatJoinsAllGroupsOnOneContendedChannelCanTalk) {
  MediumOptions medium;
  medium.contention = true;
  medium.range = 25.0;
  Team team(medium, 1);
  Random random(7);
  constexpr std::size_t kRobots = 60;
  for (std::size_t i = 0; i < kRobots; ++i) {
    const double x = 77.0 * random.uniform();
    team.add({}, x, 77.0 * random.uniform());
  }
  team.run_for(6s);
  std::vector<SendId> sends;
  for (std::size_t i = 0; i < kRobots; ++i) {
    sends.push_back(team.send(i, Team::name((i * 37 + 11) % kRobots == i ? 0 : (i * 37 + 11) % kRobots), noise(200)));
  }
  team.run_for(5s);
  std::size_t arrived = 0;
  for (std::size_t i = 0; i < kRobots; ++i) {
    const SendFinished* end = team.finished(i, sends[i]);
    if (end != nullptr && end->delivered) ++arrived;
  }
  EXPECT_GE(arrived, kRobots - 1);
}

}  // namespace
}  // namespace adhoc_communication
