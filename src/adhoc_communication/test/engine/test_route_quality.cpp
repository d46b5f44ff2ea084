// Which way packets take, and what happens where a way breaks.
#include <gtest/gtest.h>

#include "payloads.hpp"
#include "routing/link_cost.hpp"
#include "routing/route_discovery.hpp"
#include "routing/route_table.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using routing::kPerfectHop;

TEST(LinkCost, IsWhatAFrameNeedsOfTransmissions) {
  EXPECT_EQ(routing::link_cost(0.0, 0.0), kPerfectHop);
  EXPECT_EQ(routing::link_cost(0.5, 0.0), 2 * kPerfectHop);
  EXPECT_EQ(routing::link_cost(0.5, 0.5), 4 * kPerfectHop);
  EXPECT_EQ(routing::link_cost(1.0, 0.5), 10 * kPerfectHop);
  EXPECT_TRUE(routing::is_unbeatable(routing::link_cost(0.5, 0.0)));
  EXPECT_FALSE(routing::is_unbeatable(routing::link_cost(0.5, 0.2)));
  EXPECT_TRUE(routing::is_fair(routing::link_cost(0.5, 0.5)));
  EXPECT_FALSE(routing::is_fair(routing::link_cost(0.6, 0.5)));
  EXPECT_EQ(routing::sum(0xfff0, 0xfff0), 0xffff);
}

std::optional<RouteState> route(Team& team, std::size_t from, std::size_t to) {
  for (const RouteState& route : team.engine(from).routes()) {
    if (route.destination == Team::address(to) && route.valid) return route;
  }
  return std::nullopt;
}

/// What the robot puts on the air of one type, broadcast or not; nothing for other frames.
template <typename Read>
auto message_of(const Frame& frame, wire::FrameType type, Read read) -> decltype(read(std::declval<wire::Reader>())) {
  if (frame.bytes[1] != static_cast<std::uint8_t>(type)) return std::nullopt;
  return read(wire::Reader(frame.bytes.data() + wire::kHeaderSize,
                           frame.bytes.size() - wire::kHeaderSize - wire::kChecksumSize));
}

/// Packets of 100 octets, one every 50 ms.
std::vector<SendId> flow(Team& team, std::size_t from, std::size_t to, int packets) {
  std::vector<SendId> ids;
  for (int i = 0; i < packets; ++i) {
    ids.push_back(team.send(from, Team::name(to), noise(100)));
    team.run_for(50ms);
  }
  return ids;
}

/// 0 and 1 hear each other badly, and both hear 2 well.
TEST(RouteQuality, TwoGoodHopsAreTakenInsteadOfOneBad) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Team team({}, seed);
    for (int i = 0; i < 3; ++i) team.add();
    team.medium().set_link_loss(0, 1, 0.8);
    team.run_for(20s);
    flow(team, 0, 1, 20);
    ASSERT_TRUE(route(team, 0, 1)) << seed;
    EXPECT_EQ(route(team, 0, 1)->hops, 2) << seed;
    EXPECT_EQ(route(team, 0, 1)->next_hop, Team::address(2)) << seed;
    EXPECT_NEAR(route(team, 0, 1)->cost, 2.0, 0.4) << seed;
  }
}

TEST(RouteQuality, OneFairHopIsTakenInsteadOfTwoGood) {
  Team team;
  for (int i = 0; i < 3; ++i) team.add();
  team.medium().set_link_loss(0, 1, 0.2);
  team.run_for(20s);
  flow(team, 0, 1, 20);
  ASSERT_TRUE(route(team, 0, 1));
  EXPECT_EQ(route(team, 0, 1)->hops, 1);
}

/// A square whose left half is bad: 0 - 1 - 3 over lossy links, 0 - 2 - 3 over clean ones.
TEST(RouteQuality, OfTwoWaysOfTheSameLengthTheCleanOneIsTaken) {
  int clean = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Team team({}, seed);
    team.add({}, 0, 0);
    team.add({}, 7, 4);
    team.add({}, 7, -4);
    team.add({}, 14, 0);
    team.medium().set_link_loss(0, 1, 0.5);
    team.medium().set_link_loss(1, 3, 0.5);
    team.run_for(40s);  // routes of the start, when nothing was known of the links, have ended
    flow(team, 0, 3, 5);
    ASSERT_TRUE(route(team, 0, 3)) << seed;
    if (route(team, 0, 3)->next_hop == Team::address(2)) ++clean;
  }
  EXPECT_GE(clean, 18);  // what is known of an idle link are a few beacons
}

/// 0 - 1 - 2 - 3, and 4 beside 2: the link from 1 to 2 dies under way.
struct Detour {
  Detour() {
    team.add({}, 0, 0);
    team.add({}, 8, 0);
    team.add({}, 16, 0);
    team.add({}, 24, 0);
    team.add({}, 16, 4);
    for (const std::size_t far : {0, 2, 3, 4}) team.medium().set_link_loss(far, 4, far == 0 ? 1.0 : 0.0);
    team.medium().set_link_loss(1, 4, 0.0);
    team.run_for(2s);
  }
  void watch() {
    team.on_transmission = [this](std::size_t robot, const Frame& frame) {
      const auto request = message_of(frame, wire::FrameType::kRouteRequest, wire::read_route_request);
      if (request && request->originator == Team::address(robot) && frame.destination == wire::kEverybody) {
        hop_limits.push_back(request->hop_limit);
      }
      const auto error = message_of(frame, wire::FrameType::kRouteError, wire::read_route_error);
      if (!error) return;
      for (const auto& lost : error->destinations) announced.insert({robot, lost.address});
    };
  }

  Team team;
  std::vector<int> hop_limits;                             ///< of requests, where they began
  std::set<std::pair<std::size_t, MacAddress>> announced;  ///< who told that whom cannot be reached
};

/// 0 and 1 hear each other well at first, and 2 well all the time.
TEST(RouteExchange, AFadingLinkIsLeftForAWayRound) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Team team({}, seed);
    for (int i = 0; i < 3; ++i) team.add();
    team.run_for(20s);
    flow(team, 0, 1, 20);
    ASSERT_EQ(route(team, 0, 1)->hops, 1) << seed;
    team.medium().set_link_loss(0, 1, 0.8);
    flow(team, 0, 1, 100);
    ASSERT_TRUE(route(team, 0, 1)) << seed;
    EXPECT_EQ(route(team, 0, 1)->next_hop, Team::address(2)) << seed;
    EXPECT_NEAR(route(team, 0, 1)->cost, 2.0, 0.4) << seed;
    team.run_for(2s);
    EXPECT_EQ(team.received(1).size(), 120u) << seed;
  }
}

/// 0 - 1 - 2 - 3 with 4 beside 2: who has the fading link asks, not the source.
TEST(RouteExchange, ARelayAsksForItsOwnHopAndCarriesDataMeanwhile) {
  Detour detour;
  Team& team = detour.team;
  team.run_for(20s);
  flow(team, 0, 3, 20);
  ASSERT_TRUE(route(team, 1, 3));
  const std::size_t relay = route(team, 1, 3)->next_hop == Team::address(2) ? 2 : 4;
  const std::uint32_t before = route(team, 1, 3)->sequence;
  std::set<std::size_t> askers;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const auto request = message_of(frame, wire::FrameType::kRouteRequest, wire::read_route_request);
    if (request && request->originator == Team::address(robot)) askers.insert(robot);
    EXPECT_FALSE(message_of(frame, wire::FrameType::kRouteError, wire::read_route_error));
  };
  team.medium().set_link_loss(1, relay, 0.65);
  flow(team, 0, 3, 100);
  askers.erase(relay);  // for the way back of the acknowledgments
  EXPECT_EQ(askers, std::set<std::size_t>{1});
  EXPECT_EQ(route(team, 1, 3)->next_hop, Team::address(6 - relay));
  EXPECT_GT(route(team, 1, 3)->sequence, before);
  team.run_for(2s);
  EXPECT_EQ(team.received(3).size(), 120u);
}

/// Requests of robot 0 while it sends to robot 1 and their link, which was good, loses so much.
std::size_t requests_while_fading(Team& team, double loss, int packets) {
  std::set<std::uint32_t> requests;
  team.run_for(20s);
  flow(team, 0, 1, 20);
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const auto request = message_of(frame, wire::FrameType::kRouteRequest, wire::read_route_request);
    if (request && robot == 0 && request->originator == Team::address(0)) requests.insert(request->id);
  };
  team.medium().set_link_loss(0, 1, loss);
  flow(team, 0, 1, packets);
  team.on_transmission = nullptr;
  return requests.size();
}

TEST(RouteExchange, NobodyAsksAboutALinkThatNoWayRoundCanBeat) {
  Team team;
  for (int i = 0; i < 3; ++i) team.add();
  EXPECT_EQ(requests_while_fading(team, 0.3, 100), 0u);
}

/// All of a large team would pass the request on for a few packets.
TEST(RouteExchange, ItIsAskedOnlyOnceTheLinkHasCostAsMuchAsARequest) {
  Team team;
  for (int i = 0; i < 40; ++i) team.add();
  EXPECT_EQ(requests_while_fading(team, 0.7, 10), 0u);
}

/// Where no way is better, it is not asked again and again.
TEST(RouteExchange, WithoutAWayRoundItIsAskedAFewTimesAtMost) {
  Team team;
  team.add_line(2);
  EXPECT_LE(requests_while_fading(team, 0.55, 200), 3u);
  team.run_for(5s);
  EXPECT_EQ(team.received(1).size(), 220u);
}

/// 0 - 1 - 2 - 3 - 4, until 5 comes, which hears both ends.
struct Shortcut {
  explicit Shortcut(std::uint64_t seed = 1) : team(Team({}, seed)) {
    team.add_line(5);
    team.run_for(20s);
    flow(team, 0, 4, 20);
    team.on_transmission = [this](std::size_t robot, const Frame& frame) {
      const auto request = message_of(frame, wire::FrameType::kRouteRequest, wire::read_route_request);
      if (!request || request->destination != Team::address(4)) return;
      if (request->originator == Team::address(robot)) requests.insert({robot, request->id});
    };
  }
  void come(double loss) {
    team.add();
    for (const std::size_t other : {0, 1, 2, 3, 4}) {
      team.medium().set_link_loss(other, 5, other % 4 == 0 ? loss : 1.0);
    }
  }
  std::size_t requests_of(std::size_t robot) const {
    return std::count_if(requests.begin(), requests.end(), [&](const auto& each) { return each.first == robot; });
  }

  Team team;
  std::set<std::pair<std::size_t, std::uint32_t>> requests;
};

/// All links stayed good, so the longer way was kept for as long as data went along it.
TEST(RouteExchange, AShorterWayThatComesUpIsTakenByTheSource) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Shortcut shortcut(seed);
    Team& team = shortcut.team;
    ASSERT_EQ(route(team, 0, 4)->hops, 4) << seed;
    shortcut.come(0.0);
    flow(team, 0, 4, 100);
    EXPECT_EQ(route(team, 0, 4)->next_hop, Team::address(5)) << seed;
    EXPECT_EQ(route(team, 0, 4)->hops, 2) << seed;
    EXPECT_LE(shortcut.requests_of(0), 2u) << seed;
    EXPECT_EQ(shortcut.requests_of(1) + shortcut.requests_of(2) + shortcut.requests_of(3), 0u) << seed;
    team.run_for(2s);
    EXPECT_EQ(team.received(4).size(), 120u) << seed;
  }
}

/// What is shorter only in hops is looked for now and then.
TEST(RouteExchange, AWayThatIsShorterButNotBetterIsAskedForRarely) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Shortcut shortcut(seed);
    shortcut.come(0.45);
    flow(shortcut.team, 0, 4, 400);
    EXPECT_LE(shortcut.requests_of(0), 3u) << seed;
  }
}

/// There is a route: nobody waits for the exchange, nobody hears that it failed, and what needs a route goes before it.
TEST(RouteExchange, EndsWithoutAWordAndGivesWayToASearchAndARepair) {
  const auto untold = [](const routing::Target&) { return std::uint8_t{0}; };
  const MacAddress far = Team::address(7);
  const EngineOptions options;
  for (const char* then : {"nothing", "search", "repair"}) {
    Random random(1);
    routing::RouteDiscovery discovery(options, random);
    ASSERT_TRUE(discovery.exchange(far, 5, 3, 0s));
    EXPECT_FALSE(discovery.exchange(far, 5, 3, 0s)) << "once at a time";
    const auto steps = discovery.poll(untold, 0s);
    ASSERT_EQ(steps.size(), 1u);
    EXPECT_EQ(steps.front().newer_than, 5u);
    EXPECT_FALSE(discovery.searching({far, {}}));
    if (then == std::string("search")) discovery.search({far, {}}, 0, 0, 1ms);
    if (then == std::string("repair")) EXPECT_TRUE(discovery.repair(far, 3, 1ms));
    EXPECT_EQ(discovery.searching({far, {}}), then != std::string("nothing"));
    for (Time now = 1ms; now < 30s; now += 10ms) {
      for (const auto& step : discovery.poll(untold, now)) EXPECT_FALSE(step.newer_than);
    }
    EXPECT_EQ(discovery.take_failures().size(), then == std::string("nothing") ? 0u : 1u) << then;
  }
}

TEST(LocalRepair, A10_1_A10_2_A10_3_DataWaitsWhereTheRouteBroke) {
  Detour detour;
  Team& team = detour.team;
  flow(team, 0, 3, 5);
  ASSERT_TRUE(route(team, 1, 3));
  const std::size_t relay = route(team, 1, 3)->next_hop == Team::address(2) ? 2 : 4;
  detour.watch();
  const std::uint32_t before = route(team, 1, 3)->sequence;
  team.kill(relay);
  const std::vector<SendId> ids = flow(team, 0, 3, 20);
  team.run_for(1s);
  for (const SendId id : ids) {
    ASSERT_TRUE(team.finished(0, id));
    EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  }
  EXPECT_EQ(team.received(3).size(), 25u);
  // Robot 1 searched: 2 hops to the destination and LOCAL_ADD_TTL; the source never had to.
  EXPECT_EQ(detour.hop_limits, std::vector<int>{4});
  EXPECT_EQ(detour.announced.count({1, Team::address(3)}), 0u);
  EXPECT_EQ(route(team, 1, 3)->hops, 2);
  EXPECT_GT(route(team, 1, 3)->sequence, before);
}

TEST(LocalRepair, A10_3_FailureIsAnnounced) {
  Team team;
  team.add_line(4);
  team.run_for(2s);
  flow(team, 0, 3, 5);
  std::size_t errors = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (robot == 1 && frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kRouteError)) ++errors;
  };
  team.kill(2);
  const std::vector<SendId> ids = flow(team, 0, 3, 3);
  team.run_for(15s);  // until robot 3 is not taken to live any more
  EXPECT_GE(errors, 1u);
  for (const SendId id : ids) {
    ASSERT_TRUE(team.finished(0, id));
    EXPECT_FALSE(team.finished(0, id)->delivered);
  }
  EXPECT_FALSE(route(team, 0, 3));
}

/// 0 - 1 - 2 - 3 as before, but the way round has one hop more: 1 - 4 - 5 - 3.
TEST(LocalRepair, A7_11_A10_4_ALongerRouteIsToldWithoutDeletingAny) {
  Team team;
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {8.0, 0.0}, {16.0, 0.0}, {24.0, 0.0}, {10.0, 9.0}, {19.0, 8.0}}) {
    team.add({}, x, y);
  }
  team.medium().set_link_loss(2, 4, 1.0);
  team.medium().set_link_loss(2, 5, 1.0);
  team.run_for(2s);
  flow(team, 0, 3, 5);
  ASSERT_TRUE(route(team, 1, 3));
  ASSERT_EQ(route(team, 1, 3)->next_hop, Team::address(2));
  std::size_t gentle = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const auto error = message_of(frame, wire::FrameType::kRouteError, wire::read_route_error);
    if (robot != 1 || !error || error->destinations[0].address != Team::address(3)) return;
    EXPECT_TRUE(error->no_delete);
    ++gentle;
  };
  team.kill(2);
  const std::vector<SendId> ids = flow(team, 0, 3, 20);
  team.run_for(1s);
  EXPECT_EQ(gentle, 1u);
  EXPECT_TRUE(route(team, 0, 3));
  ASSERT_TRUE(route(team, 1, 3));
  EXPECT_EQ(route(team, 1, 3)->hops, 3);
  for (const SendId id : ids) {
    ASSERT_TRUE(team.finished(0, id));
    EXPECT_TRUE(team.finished(0, id)->delivered);
  }
}

/// 30 % of all frames are lost, beacons come once a second: in five hours of four robots, hardly anybody is thought
/// lost.
TEST(Presence, A8_4_QuietNeighborsAreAskedBeforeTheyAreGivenUp) {
  MediumOptions medium;
  medium.loss = 0.3;
  int disturbed = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Team team(medium, seed);
    for (int i = 0; i < 4; ++i) team.add();
    team.run_for(30s);
    for (std::size_t robot = 0; robot < 4; ++robot) team.presence(robot).clear();
    team.run_for(10min);
    bool quiet = true;
    for (std::size_t robot = 0; robot < 4; ++robot) quiet = quiet && team.presence(robot).empty();
    disturbed += quiet ? 0 : 1;
  }
  EXPECT_LE(disturbed, 3);
}

/// More neighbours than one beacon names.
TEST(Presence, NeighborsTakeTurnsInBeacons) {
  Team team;
  EngineOptions options;
  options.join_groups_automatically = false;
  for (int i = 0; i < 60; ++i) team.add(options);
  team.run_for(10s);
  for (std::size_t robot = 0; robot < 60; ++robot) {
    for (const LinkState& link : team.engine(robot).links()) ASSERT_TRUE(link.two_way) << robot;
    ASSERT_EQ(team.engine(robot).links().size(), 59u);
  }
  team.run_for(60s);
  for (std::size_t robot = 0; robot < 60; ++robot) EXPECT_EQ(team.presence(robot).size(), 59u) << robot;
}

/// Robot 0 hears 1, which hears nobody: its requests are not believed until it acknowledges something (section 6.8).
TEST(OneWayLinks, A5_3_A9_2_A9_3_RepliesThatGetLostBlacklistTheNeighbor) {
  EngineOptions options;
  options.num_link_retrans = 0;  // so that RREP-ACK is what acknowledges replies
  Team team;
  for (int i = 0; i < 3; ++i) team.add(options);
  team.medium().set_link_loss(0, 1, 0.0);
  team.run_for(2s);
  team.medium().set_one_way_loss(0, 1, 1.0);
  std::size_t acknowledgments = 0;
  team.on_transmission = [&](std::size_t, const Frame& frame) {
    if (frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kRouteReplyAcknowledgment)) ++acknowledgments;
  };
  team.run_for(12s);
  const SendId id = team.send(1, "robot_0", text("by way of robot_2"));
  team.run_until_done([&] { return team.finished(1, id) != nullptr; }, 10s);
  ASSERT_TRUE(team.finished(1, id));
  EXPECT_TRUE(team.finished(1, id)->delivered) << team.finished(1, id)->reason;
  EXPECT_EQ(team.received(0).size(), 1u);
}

}  // namespace
}  // namespace adhoc_communication
