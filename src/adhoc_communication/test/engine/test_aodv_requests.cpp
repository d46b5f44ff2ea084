// Asking for routes, and passing on what others ask: A4 and A5 of docs/aodv.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "host.hpp"
#include "routing/route_discovery.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

EngineOptions with(const Timings& timings) {
  EngineOptions options;
  options.timings = timings;
  return options;
}

/// The RFC's expanding ring.
EngineOptions with_ring(const Timings& timings = robot_timings()) {
  EngineOptions options = with(timings);
  options.hop_limit_min = 1;
  options.hop_limit_increment = 2;
  return options;
}

/// A node with a neighbour on either side.
struct RequestLine : Stage {
  explicit RequestLine(EngineOptions options = {}) : Stage(std::move(options)), a(neighbor(1)), b(neighbor(2)) {
    run_for(50ms);
  }
  void lose(Host& host) {
    host.beacons = host.acknowledges = false;
    run_for(3s);
    forget();
  }
  /// An answer to the node's search, by way of b.
  void answer(const Host& destination) { say(b, reply_about(destination, self()), self().address); }
  Host& a;
  Host& b;
};

TEST(Requests, A4_1_ARouteIsAskedForWhenDataIsDueAndThereIsNone) {
  RequestLine line;
  line.run_for(1s);
  EXPECT_TRUE(line.requests().empty());
  line.team.send(0, kFar.name, text("x"));
  line.run_for(10ms);
  EXPECT_EQ(line.requests().size(), 1u);
  EXPECT_TRUE(line.sent<wire::Data>().empty());
  line.answer(kFar);
  line.run_for(5ms);
  line.team.send(0, kFar.name, text("y"));
  line.run_for(1s);
  EXPECT_EQ(line.requests().size(), 1u);
  EXPECT_GE(line.sent<wire::Data>().size(), 2u);
}

TEST(Requests, A4_2_TheLastKnownNumberIsAskedFor) {
  RequestLine line;
  line.team.send(0, kFar.name, text("x"));
  line.run_for(10ms);
  ASSERT_EQ(line.requests().size(), 1u);
  EXPECT_TRUE(line.requests()[0].message.unknown_sequence_number);
  Host far = kFar;
  far.sequence = 40;
  line.answer(far);
  line.lose(line.b);
  line.team.send(0, kFar.name, text("y"));
  line.run_for(700ms);  // the search for the first packet goes on
  ASSERT_FALSE(line.requests().empty());
  EXPECT_FALSE(line.requests()[0].message.unknown_sequence_number);
  EXPECT_EQ(line.requests()[0].message.destination_sequence, 41u);
}

TEST(Requests, A4_3_IdsAreConsecutiveAndHopsCountFromZero) {
  RequestLine line;
  for (const char* name : {"x", "y", "z"}) line.team.send(0, name, text("x"));
  line.run_for(900ms);
  const auto requests = line.requests();
  ASSERT_GE(requests.size(), 9u);
  for (std::size_t i = 0; i < requests.size(); ++i) {
    EXPECT_EQ(requests[i].message.id, requests[0].message.id + i);
    EXPECT_EQ(requests[i].message.hop_count, 0);
  }
}

TEST(Requests, A4_4_OwnRequestsThatComeBackAreDropped) {
  RequestLine line;
  line.team.send(0, kFar.name, text("x"));
  line.run_for(10ms);
  const std::size_t before = line.node().routes().size();
  wire::RouteRequest echo = line.requests().at(0).message;
  ++echo.hop_count;
  line.say(line.b, echo);
  line.run_for(50ms);
  EXPECT_EQ(line.requests().size(), 1u);
  EXPECT_EQ(line.node().routes().size(), before);
  EXPECT_FALSE(line.entry(line.self()));
}

/// Hop limits of the requests for an absent robot, when they were sent, and what happened in the end.
struct Search {
  std::vector<int> hop_limits;
  std::vector<Time> asked;  ///< after the first
  Time failed{0};
  std::string reason;
};

Search search_in_vain(const EngineOptions& options) {
  Stage stage(options);
  stage.neighbor(1);
  stage.run_for(50ms);
  const Time start = stage.now();
  const SendId id = stage.team.send(0, "nobody", text("x"));
  for (int i = 0; i < 60 && stage.team.finished(0, id) == nullptr; ++i) stage.run_for(1s);
  Search search;
  for (const auto& request : stage.requests()) {
    search.asked.push_back(request.at - stage.requests().front().at);
    search.hop_limits.push_back(request.message.hop_limit);
  }
  search.failed = stage.team.finished_at(0, id) - start;
  search.reason = stage.team.finished(0, id)->reason;
  return search;
}

/// Each request but the first comes up to a quarter of its wait late, and puts off none of the others by that.
void expect_waits(const Search& search, const std::vector<Time>& waits) {
  ASSERT_EQ(search.asked.size(), waits.size() + 1);
  Time due{0};
  for (std::size_t i = 0; i < waits.size(); ++i) {
    due += waits[i];
    EXPECT_GE(search.asked[i + 1], due) << i;
    EXPECT_LT(search.asked[i + 1], due + waits[i] / 4) << i;
  }
}

/// A robot told of at the null address was taken for the destination of every search by name, so that failing ended
/// the sends to that robot instead.
TEST(Requests, ARumorOfTheNullAddressKeepsNoSearchOpen) {
  Stage stage;
  Host& liar = stage.neighbor(1);
  stage.run_for(50ms);
  wire::Beacon beacon{1, 1, 100, liar.name, 0, {}, {{MacAddress{}, 7, 9, 1, "ghost"}}, 0};
  stage.say(liar, beacon);
  const SendId id = stage.team.send(0, "nobody", text("x"));
  stage.run_for(30s);
  ASSERT_NE(stage.team.finished(0, id), nullptr);
  EXPECT_FALSE(stage.team.finished(0, id)->delivered);
}

TEST(Requests, A4_5_A4_6_A4_7_A12_2_TheRingOfTheRfc) {
  const Search search = search_in_vain(with_ring(rfc3561_timings()));
  EXPECT_EQ(search.hop_limits, (std::vector<int>{1, 3, 5, 7, 35, 35, 35}));
  expect_waits(search, {240ms, 400ms, 560ms, 720ms, 2800ms, 5600ms});
  EXPECT_EQ(search.failed, 21520ms);
  EXPECT_EQ(search.reason, "no route to nobody after 21.5 s");
}

TEST(Requests, A4_5_A4_6_A4_7_A12_2_TheRingOfRobots) {
  const Search search = search_in_vain(with_ring());
  EXPECT_EQ(search.hop_limits, (std::vector<int>{1, 3, 5, 7, 35, 35, 35, 35}));
  expect_waits(search, {30ms, 50ms, 70ms, 90ms, 120ms, 240ms, 480ms});
  EXPECT_EQ(search.failed, 2040ms);
}

TEST(Requests, A4_7_A12_2_WithoutRingThereAreOnlyTriesAtFullReach) {
  const Search rfc = search_in_vain(with(rfc3561_timings()));
  EXPECT_EQ(rfc.hop_limits, std::vector<int>(3, 35));
  EXPECT_EQ(rfc.failed, 19600ms);
  const Search robots = search_in_vain({});
  expect_waits(robots, {120ms, 240ms, 480ms});
  EXPECT_EQ(robots.failed, 1800ms);
}

TEST(Requests, A4_8_TheRingForALostRouteStartsALittleBeyondItsLength) {
  RequestLine line(with_ring());
  line.give_route(line.b, kFar, 5);
  line.lose(line.b);
  line.team.send(0, kFar.name, text("x"));
  line.run_for(1ms);
  ASSERT_EQ(line.requests().size(), 1u);
  EXPECT_EQ(line.requests()[0].message.hop_limit, 7);
}

TEST(Requests, A4_9_RequestsAreLimitedInRateAndAllGoOut) {
  EngineOptions options = with(robot_timings());
  options.timings.request_rate_limit = 5;
  for (const auto& [chosen, limit] : {std::pair(EngineOptions{}, 10u), std::pair(options, 5u)}) {
    RequestLine line(chosen);
    std::set<std::string> asked;
    for (int i = 0; i < 60; ++i) line.team.send(0, "nobody_" + std::to_string(i), text("x"));
    line.run_for(60s);
    const auto requests = line.requests();
    for (const auto& request : requests) asked.insert(request.message.destination_name);
    EXPECT_EQ(asked.size(), 60u);
    ASSERT_GT(requests.size(), limit);
    // Requests may wait a moment for the radio.
    for (std::size_t i = limit; i < requests.size(); ++i) EXPECT_GE(requests[i].at - requests[i - limit].at, 999ms);
  }
}

TEST(Requests, A4_10_DataWaitsInOrderForTheRoute) {
  RequestLine line;
  for (int i = 0; i < 20; ++i) line.team.send(0, kFar.name, text(std::to_string(i)));
  line.run_for(10ms);
  EXPECT_TRUE(line.sent<wire::Data>().empty());
  line.answer(kFar);
  line.run_for(20ms);
  const auto data = line.sent<wire::Data>();
  ASSERT_GE(data.size(), 20u);
  for (std::size_t i = 1; i < 20; ++i) EXPECT_EQ(data[i].message.packet, data[i - 1].message.packet + 1);
}

TEST(Requests, A4_10_WithoutRouteAllThatWaitsFails) {
  RequestLine line;
  std::vector<SendId> ids;
  for (int i = 0; i < 20; ++i) ids.push_back(line.team.send(0, "nobody", text("x")));
  line.run_for(2s);
  for (const SendId id : ids) {
    ASSERT_TRUE(line.team.finished(0, id));
    EXPECT_EQ(line.team.finished(0, id)->reason, "no route to nobody after 1.8 s");
  }
  EXPECT_EQ(line.node().queues().packets, 0u);
}

TEST(Requests, A4_11_WhatWaitsIsBoundedAndTheNewestIsRefused) {
  RequestLine line;
  std::vector<SendId> ids;
  for (int i = 0; i < 20'000; ++i) {
    ids.push_back(line.team.send(0, "nobody_" + std::to_string(i % 50), noise(100)));
    EXPECT_LE(line.node().queues().packets, 256u);
  }
  line.run_for(1ms);
  EXPECT_FALSE(line.team.finished(0, ids[255]));
  for (std::size_t i = 256; i < ids.size(); ++i) ASSERT_TRUE(line.team.finished(0, ids[i])) << i;
  EXPECT_EQ(line.team.finished(0, ids[256])->reason, "send queue is full (256 packets waiting)");
}

TEST(Requests, A4_12_TheDestinationIsToldTheWayBack) {
  RequestLine line;
  line.team.send(0, kFar.name, text("x"));
  line.run_for(10ms);
  ASSERT_EQ(line.requests().size(), 1u);
  EXPECT_TRUE(line.requests()[0].message.gratuitous) << "packets are acknowledged end to end";
}

TEST(Requests, A4_13_A7_7_AnEntryIsKeptWhileItsRouteIsAskedFor) {
  RequestLine line(with(rfc3561_timings()));
  line.give_route(line.b, kFar);
  line.lose(line.b);
  const Time deleted = line.entry(kFar)->expires;
  line.run_for(deleted - line.now() - 2s);
  line.team.send(0, kFar.name, text("x"));
  line.run_for(10ms);
  ASSERT_TRUE(line.entry(kFar));
  EXPECT_GE(line.entry(kFar)->expires, line.now() + 2 * rfc3561_timings().net_traversal_time());
  line.forget();
  line.run_for(8s);
  ASSERT_FALSE(line.requests().empty());
  EXPECT_FALSE(line.requests().back().message.unknown_sequence_number);
}

TEST(Requests, A5_1_A5_2_ARepeatedRequestIsDroppedButItsTransmitterNoted) {
  Stage stage;
  Host& b = stage.neighbor(2, false);
  stage.acknowledge(b);
  stage.say(b, request_for(kFar, kFarther));
  stage.run_for(1s);
  const Time before = stage.route(b)->expires;
  stage.say(b, request_for(kFar, kFarther));
  stage.run_for(100ms);
  EXPECT_EQ(stage.route(b)->expires, before + 1s);
  EXPECT_EQ(stage.requests().size(), 1u);
}

/// A run counts its requests from the beginning: the first ones of the next run had the numbers of the first ones of
/// the run before, and were taken for repetitions.
TEST(Requests, A5_2_TheNextRunOfARobotCountsAnew) {
  Stage stage;
  Host& b = stage.neighbor(2, false);
  stage.acknowledge(b);
  Host restarted = kFarther;
  restarted.boot_id[0] ^= 0xff;
  stage.say(b, request_for(kFar, kFarther));
  stage.run_for(100ms);
  EXPECT_EQ(stage.requests().size(), 1u);
  for (int i = 0; i < 2; ++i) {
    stage.say(b, request_for(kFar, restarted));
    stage.run_for(100ms);
    EXPECT_EQ(stage.requests().size(), 2u);
  }
}

/// How often a request is passed on that a says, b repeats at once, and a once more after the pause.
std::size_t passed_on_with(const Timings& timings, Time pause) {
  RequestLine line(with(timings));
  line.neighbor(3);  // has it from nobody else
  line.run_for(50ms);
  line.say(line.a, request_for(kFar, kFarther));
  line.say(line.b, request_for(kFar, kFarther));
  line.run_for(pause);
  line.say(line.a, request_for(kFar, kFarther));
  line.run_for(100ms);
  return line.requests().size();
}

TEST(Requests, A5_2_RequestsAreRememberedForTheTimeOfADiscovery) {
  EXPECT_EQ(passed_on_with(rfc3561_timings(), 5500ms), 1u);
  EXPECT_EQ(passed_on_with(rfc3561_timings(), 5700ms), 2u);
  EXPECT_EQ(passed_on_with(robot_timings(), 9900ms), 1u);
  EXPECT_EQ(passed_on_with(robot_timings(), 10100ms), 2u);
}

TEST(Requests, A5_4_A5_5_A5_6_TheWayBackToTheOriginator) {
  RequestLine line(with(rfc3561_timings()));
  Host originator = kFarther;
  originator.sequence = 10;
  wire::RouteRequest request = request_for(kFar, originator);
  request.hop_count = 4;
  line.say(line.a, request);
  const auto back = line.route(originator);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->hops, 5);
  EXPECT_EQ(back->sequence, 10u);
  EXPECT_TRUE(back->sequence_valid);
  EXPECT_EQ(back->next_hop, line.a.address);
  EXPECT_EQ(back->expires - line.now(), 5200ms) << "2 * 2800 ms - 2 * 5 * 40 ms";
}

TEST(Requests, A5_5_ARequestWithAnOldNumberLeavesTheRouteAsItIs) {
  RequestLine line;
  Host originator = kFarther;
  originator.sequence = 10;
  line.say(line.a, request_for(kFar, originator, 1));
  originator.sequence = 5;
  line.say(line.b, request_for(kFar, originator, 2));
  EXPECT_EQ(line.route(originator)->sequence, 10u);
  EXPECT_EQ(line.route(originator)->next_hop, line.a.address);
  originator.sequence = 11;
  line.say(line.b, request_for(kFar, originator, 3));
  EXPECT_EQ(line.route(originator)->next_hop, line.b.address);
}

TEST(Requests, A5_6_TheWayBackIsNotShortened) {
  RequestLine line;
  line.give_route(line.a, kFarther, 1, 30s);
  Host originator = kFarther;
  ++originator.sequence;
  line.say(line.a, request_for(kFar, originator));
  EXPECT_EQ(line.route(originator)->sequence, 2u);
  EXPECT_EQ(line.route(originator)->expires, line.now() + 30s);
}

TEST(Requests, A5_7_TheWayBackCarriesData) {
  RequestLine line;
  line.say(line.a, request_for(kFar, kFarther));
  line.run_for(5ms);
  line.forget();
  line.team.send(0, kFarther.name, text("x"));
  line.run_for(10ms);
  EXPECT_TRUE(line.requests().empty());
  const auto data = line.sent<wire::Data>();
  ASSERT_FALSE(data.empty());
  EXPECT_EQ(data[0].to, line.a.address);
}

TEST(Requests, A5_8_TheHopLimitEndsARequest) {
  const auto passed_on = [](std::uint8_t hop_limit) {
    RequestLine line;
    wire::RouteRequest request = request_for(kFar, kFarther);
    request.hop_limit = hop_limit;
    request.hop_count = 1;
    line.say(line.a, request);
    line.run_for(10ms);
    EXPECT_EQ(line.malformed(), hop_limit == 0 ? 1u : 0u);
    EXPECT_EQ(line.route(kFarther).has_value(), hop_limit != 0);
    for (const auto& sent : line.requests()) {
      EXPECT_EQ(sent.message.hop_limit, hop_limit - 1);
      EXPECT_EQ(sent.message.hop_count, 2);
    }
    return line.requests().size();
  };
  EXPECT_EQ(passed_on(3), 1u);
  EXPECT_EQ(passed_on(2), 1u);
  EXPECT_EQ(passed_on(1), 0u);
  EXPECT_EQ(passed_on(0), 0u);
}

/// The number asked for in the copy, where the node knows number 10.
std::uint32_t passed_on_number(bool unknown, std::uint32_t asked) {
  RequestLine line;
  Host far = kFar;
  far.sequence = 10;
  line.give_route(line.b, far);
  wire::RouteRequest request = request_for(kFar, kFarther);
  request.destination_only = true;
  request.unknown_sequence_number = unknown;
  request.destination_sequence = asked;
  line.say(line.a, request);
  line.run_for(10ms);
  EXPECT_EQ(line.route(kFar)->sequence, 10u);
  EXPECT_FALSE(line.requests().at(0).message.unknown_sequence_number);
  return line.requests().at(0).message.destination_sequence;
}

TEST(Requests, A5_9_ACopyAsksForTheNewestNumberKnown) {
  EXPECT_EQ(passed_on_number(false, 4), 10u);
  EXPECT_EQ(passed_on_number(false, 20), 20u);
  EXPECT_EQ(passed_on_number(true, 0), 10u);
}

TEST(Requests, A5_10_WhoAnswersDoesNotPassOn) {
  RequestLine line;
  line.say(line.a, request_for(line.self(), kFarther));
  line.give_route(line.b, kFar);
  line.say(line.a, request_for(kFar, kFarther, 2));
  line.run_for(50ms);
  EXPECT_TRUE(line.requests().empty());
  EXPECT_EQ(line.sent<wire::RouteReply>().size(), 2u);
}

TEST(Requests, A5_11_OwnRequestsAreDroppedAlsoWhenForgotten) {
  RequestLine line;
  line.team.send(0, kFar.name, text("x"));
  line.run_for(10ms);
  const wire::RouteRequest own = line.requests().at(0).message;
  line.run_for(robot_timings().path_discovery_time() + 1s);
  line.forget();
  line.say(line.b, own);
  line.run_for(100ms);
  EXPECT_TRUE(line.requests().empty());
  EXPECT_FALSE(line.entry(line.self()));
}

/// When robots other than 0 broadcast a request of robot 0.
std::set<Time> passed_on_at(Team& team) {
  team.run_for(2s);
  std::set<Time> times;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const bool request = frame.bytes[1] == static_cast<std::uint8_t>(FrameType::kRouteRequest);
    if (robot != 0 && request && frame.destination == wire::kEverybody) times.insert(team.now());
  };
  team.send(0, "nobody", text("x"));
  team.run_for(50ms);
  return times;
}

TEST(Requests, A5_12_NeighborsDoNotPassARequestOnAllAtOnce) {
  Team team;
  team.add(without_groups(), 0, 0);
  for (const double distance : {8.0, 16.0}) {  // each of the outer ten depends on one of the inner ten
    for (int i = 0; i < 10; ++i) {
      team.add(without_groups(), distance * std::cos(0.2 * M_PI * i), distance * std::sin(0.2 * M_PI * i));
    }
  }
  const std::set<Time> times = passed_on_at(team);
  ASSERT_GE(times.size(), 10u);
  EXPECT_LE(*std::next(times.begin(), 9) - *times.begin(), 10ms);
  EXPECT_GE(*std::next(times.begin(), 9) - *times.begin(), 500us);
}

TEST(Requests, A5_8_InACrowdFewNeedToPassARequestOn) {
  Team team;
  for (int i = 0; i < 30; ++i) team.add(without_groups());
  const std::set<Time> times = passed_on_at(team);
  EXPECT_GE(times.size(), 1u);
  EXPECT_LE(times.size(), 3u);
}

}  // namespace
}  // namespace adhoc_communication
