// Beacons, and how lost neighbours are noticed: A8 of docs/aodv.md.
#include <gtest/gtest.h>

#include "host.hpp"
#include "routing/neighbors.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

/// With the repetition on each hop, quiet neighbours are asked, and silence shows sooner.
EngineOptions hellos_only(const Timings& timings, std::chrono::milliseconds interval) {
  EngineOptions options;
  options.timings = timings;
  options.beacon_interval = interval;
  options.num_link_retrans = 0;
  return options;
}

TEST(Hello, A8_3_ABeaconMakesARouteWithTheNumberOfItsSender) {
  for (const Timings& timings : {rfc3561_timings(), robot_timings()}) {
    Stage stage(hellos_only(timings, 250ms));
    Host& b = stage.neighbor(2, false);
    b.sequence = 40;
    b.announced_interval_ms = 500;
    stage.beacon(b);
    const auto route = stage.route(b);
    ASSERT_TRUE(route);
    EXPECT_EQ(route->hops, 1);
    EXPECT_EQ(route->next_hop, b.address);
    EXPECT_EQ(route->sequence, 40u);
    EXPECT_TRUE(route->sequence_valid);
    EXPECT_EQ(route->expires, stage.now() + timings.allowed_hello_loss * 500ms);
    b.sequence = 42;
    stage.beacon(b);
    EXPECT_EQ(stage.route(b)->sequence, 42u);
  }
}

/// Whether a neighbour, and the route behind it, are there so long after its last sign of life.
bool is_there(const EngineOptions& options, Time silence, bool sign_of_life = false) {
  Stage stage(options);
  Host& a = stage.neighbor(1);
  Host& b = stage.neighbor(2, false);
  stage.beacon(b);
  stage.say(a, request_for(kFar, a));
  stage.say(b, reply_about(kFar, a), stage.self().address);
  if (sign_of_life) {
    stage.run_for(silence / 2);
    stage.acknowledge(b);
  }
  stage.run_for(silence);
  const bool there = stage.node().links()[1].two_way;
  EXPECT_EQ(stage.route(kFar).has_value(), there || stage.count(FrameType::kRouteError) == 0);
  return there;
}

TEST(Hello, A8_4_ASilentNeighborIsLostAfterAllowedHelloLoss) {
  const EngineOptions rfc = hellos_only(rfc3561_timings(), 1000ms);
  EXPECT_TRUE(is_there(rfc, 1990ms));
  EXPECT_FALSE(is_there(rfc, 2010ms));
  EXPECT_TRUE(is_there(rfc, 1990ms, true)) << "any sign that it hears the node counts";
  const EngineOptions robots = hellos_only(robot_timings(), 250ms);
  EXPECT_TRUE(is_there(robots, 1990ms));
  EXPECT_FALSE(is_there(robots, 2010ms));
  EXPECT_TRUE(is_there(robots, 1990ms, true));
}

/// How long a neighbour is held after its last beacon, of which one in `of` has arrived.
Time held(int of) {
  const Timings timings = robot_timings();
  routing::Neighbors neighbors(timings, 250ms);
  const MacAddress address{2, 0, 0, 0, 0, 1};
  wire::Beacon beacon;
  beacon.heard.push_back({7, 0});
  Time now = 1s;
  for (int i = 1; i <= 20; ++i) {
    now += of * 250ms;
    beacon.number = static_cast<std::uint16_t>(i * of);
    neighbors.heard(address, 1, now);
    neighbors.beacon(address, beacon, 7, now);
  }
  const Time last = now;
  while (neighbors.two_way(address, now)) now += 10ms;
  return now - last;
}

TEST(Hello, A8_4_MoreBeaconsOfALossyNeighborAreWaitedForButNotOfAHopelessOne) {
  EXPECT_EQ(held(1), 2000ms);
  EXPECT_GE(held(2), 3200ms) << "as unlikely to be missed in a row as 8 of which 30 % are lost";
  EXPECT_LE(held(2), 4000ms);
  EXPECT_EQ(held(4), 2000ms);
}

TEST(Hello, A8_4_AFrameForTheNodeAloneIsASignThatItIsHeard) {
  for (const bool listed : {true, false}) {
    Stage stage(hellos_only(robot_timings(), 250ms));
    Host& b = stage.neighbor(2, false);
    if (listed) stage.beacon(b);
    for (int i = 0; i < 4; ++i) {
      stage.run_for(1s);
      stage.say(b, request_for(kFar, b), stage.self().address);
    }
    ASSERT_EQ(stage.node().links().size(), 1u);
    EXPECT_EQ(stage.node().links()[0].two_way, listed) << "by itself it makes no link";
  }
}

TEST(Hello, A8_4_TheRoutesOverALostNeighborAreAnnounced) {
  for (const auto& [timings, interval] : {std::pair(rfc3561_timings(), 1000ms), std::pair(robot_timings(), 250ms)}) {
    Stage stage(hellos_only(timings, interval));
    Host& a = stage.neighbor(1);
    Host& b = stage.neighbor(2, false);
    stage.beacon(b);
    const Time last = stage.now();
    stage.say(a, request_for(kFar, a));
    stage.say(b, reply_about(kFar, a), stage.self().address);
    stage.run_for(5s);
    const auto errors = stage.sent<wire::RouteError>();
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_GE(errors[0].at - last, 2000ms);
    EXPECT_LE(errors[0].at - last, 2000ms + 1100ms) << "noticed with the next own beacon";
    EXPECT_FALSE(stage.route(kFar));
  }
}

TEST(Hello, A8_5_LosingANeighborThatNobodyUsesIsNotAnnounced) {
  Stage stage;
  stage.neighbor(1);
  Host& b = stage.neighbor(2);
  stage.run_for(1s);
  b.beacons = b.acknowledges = false;
  stage.run_for(6s);
  EXPECT_FALSE(stage.route(b));
  EXPECT_EQ(stage.count(FrameType::kRouteError), 0u);
}

TEST(Hello, A8_6_FramesThatNobodyAcknowledgesEndTheLink) {
  Stage stage;
  Host& a = stage.neighbor(1);
  Host& b = stage.neighbor(2);
  stage.run_for(1s);
  stage.say(a, request_for(kFar, a));
  stage.say(b, reply_about(kFar, a), stage.self().address);
  stage.run_for(5ms);
  b.acknowledges = b.beacons = false;
  const Time start = stage.now();
  stage.say(a, data_for(kFar, a), stage.self().address);
  while (stage.sent<wire::RouteError>().empty() && stage.now() - start < 2s) stage.run_for(1ms);
  EXPECT_GE(stage.now() - start, 150ms);
  EXPECT_LE(stage.now() - start, 700ms) << "silence, and a try to repair the route";
  EXPECT_FALSE(stage.route(b));
  EXPECT_GT(stage.sent<wire::Data>().size(), 2u) << "repeated before it was given up";
}

/// The sentence with which the options are refused; empty if they are not.
std::string refusal(const EngineOptions& options) {
  EngineOptions named = options;
  named.robot_name = "robot_0";
  try {
    validate(named);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

std::string refusal_of(void (*change)(Timings&)) {
  EngineOptions options;
  change(options.timings);
  return refusal(options);
}

TEST(Hello, A8_7_BothPresetsGoWithTheirIntervals) {
  EngineOptions options;
  EXPECT_EQ(refusal(options), "");
  options.timings = rfc3561_timings();
  options.beacon_interval = 1000ms;
  EXPECT_EQ(refusal(options), "");
}

TEST(Hello, A8_7_RoutesHaveToOutliveTheSilenceAllowed) {
  EngineOptions options;
  options.timings = rfc3561_timings();
  options.timings.active_route_timeout = 2s;
  options.beacon_interval = 1000ms;
  EXPECT_EQ(refusal(options),
            "parameter active_route_timeout is 2000 ms, but has to be more than the 2000 ms for which a neighbour may "
            "be silent (allowed_hello_loss * beacon_interval)");
  options.beacon_interval = 999ms;
  EXPECT_EQ(refusal(options), "");
}

TEST(Hello, A8_7_A12_1_TimingsOutOfRangeAreNamed) {
  const auto begins = [](const std::string& sentence, const std::string& start) {
    EXPECT_EQ(sentence.substr(0, start.size()), start);
  };
  begins(refusal_of([](Timings& t) { t.active_route_timeout = 0s; }), "parameter active_route_timeout is 0 ms, ");
  begins(refusal_of([](Timings& t) { t.node_traversal_time = -1ms; }), "parameter node_traversal_time is -1 ms, ");
  begins(refusal_of([](Timings& t) { t.route_request_wait = 0s; }), "parameter route_request_wait is 0 ms, ");
  begins(refusal_of([](Timings& t) { t.delete_period = 0s; }), "parameter delete_period is 0 ms, ");
  begins(refusal_of([](Timings& t) { t.shortest_memory = -1ms; }), "parameter shortest_memory is -1 ms, ");
  begins(refusal_of([](Timings& t) { t.allowed_hello_loss = 0; }), "parameter allowed_hello_loss is 0, ");
  begins(refusal_of([](Timings& t) { t.request_retries = -1; }), "parameter request_retries is -1, ");
  begins(refusal_of([](Timings& t) { t.request_rate_limit = 0; }), "parameter request_rate_limit is 0, ");
  begins(refusal_of([](Timings& t) { t.error_rate_limit = 0; }), "parameter error_rate_limit is 0, ");
  begins(refusal_of([](Timings& t) { t.timeout_buffer = -1; }), "parameter timeout_buffer is -1, ");
  begins(refusal_of([](Timings& t) { t.net_diameter = 0; }), "parameter net_diameter is 0, ");
  begins(refusal_of([](Timings& t) { t.net_diameter = 36; }), "parameter net_diameter is 36, ");
  begins(refusal_of([](Timings& t) { t.ttl_threshold = 36; }), "parameter ttl_threshold is 36, ");
  begins(refusal_of([](Timings& t) { t.local_add_ttl = -1; }), "parameter local_add_ttl is -1, ");
}

TEST(Hello, A8_7_DeletedEntriesMustNotOutrunOnesStillInUse) {
  EngineOptions options;
  options.timings.delete_period = 9s;
  EXPECT_EQ(refusal(options),
            "parameter delete_period is 9000 ms, but has to be at least active_route_timeout, which is 10000 ms");
}

}  // namespace
}  // namespace adhoc_communication
