// Lost routes, who is told, expiry and deletion: A7 of docs/aodv.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

/// A node between a, who asks, and b and c, who answer.
struct Star : Stage {
  explicit Star(EngineOptions options = {})
      : Stage(std::move(options)), a(neighbor(1)), b(neighbor(2)), c(neighbor(3)) {
    run_for(50ms);
  }
  /// A route by way of the neighbour that a relies on.
  void open_way(Host& via, const Host& destination) {
    say(a, request_for(destination, a, ++id));
    say(via, reply_about(destination, a), self().address);
    run_for(5ms);
  }
  void lose(Host& host) {
    forget();
    host.beacons = host.acknowledges = false;
    run_for(4s);
  }
  std::set<MacAddress> announced() const {
    std::set<MacAddress> result;
    for (const auto& error : sent<wire::RouteError>()) {
      for (const auto& lost : error.message.destinations) result.insert(lost.address);
    }
    return result;
  }
  Host& a;
  Host& b;
  Host& c;
  std::uint32_t id = 0;
};

TEST(Errors, A7_1_A7_2_ALostLinkTakesAllRoutesOverItAndNoOthers) {
  Star star;
  std::set<MacAddress> over_b{star.b.address};
  for (std::size_t i = 0; i < 5; ++i) {
    star.open_way(star.b, make_host(200 + i));
    over_b.insert(make_host(200 + i).address);
  }
  for (std::size_t i = 0; i < 3; ++i) star.open_way(star.c, make_host(300 + i));
  star.lose(star.b);
  ASSERT_EQ(star.sent<wire::RouteError>().size(), 1u);
  EXPECT_EQ(star.announced(), over_b);
  EXPECT_TRUE(star.route(make_host(300)));
}

TEST(Errors, A7_1_A7_4_DataWithoutRouteIsAnsweredToItsSender) {
  Star star;
  star.say(star.a, data_for(kFar, kSource), star.self().address);
  star.run_for(5ms);
  const auto errors = star.sent<wire::RouteError>();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].to, star.a.address);
  ASSERT_EQ(errors[0].message.destinations.size(), 1u);
  EXPECT_EQ(errors[0].message.destinations[0].address, kFar.address);
  EXPECT_TRUE(errors[0].message.unknown_sequence) << "nothing is known of it";
}

TEST(Errors, A7_1_A7_2_A7_5_AnErrorHeardIsPassedOnWithItsNumbers) {
  Star star;
  star.open_way(star.b, kFar);
  star.open_way(star.b, kSource);
  const std::uint32_t before = star.entry(kSource)->sequence;
  star.forget();
  star.say(star.c, error_about({{kFar, 50}}));
  star.run_for(5ms);
  EXPECT_TRUE(star.route(kFar)) << "the error came from a robot that is not the next hop";
  EXPECT_TRUE(star.sent<wire::RouteError>().empty());
  star.say(star.b, error_about({{kFar, 50}, {make_host(400), 9}}));
  star.run_for(5ms);
  const auto errors = star.sent<wire::RouteError>();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].to, star.a.address);
  ASSERT_EQ(errors[0].message.destinations.size(), 1u);
  EXPECT_EQ(errors[0].message.destinations[0].sequence, 50u);
  EXPECT_FALSE(star.entry(kFar)->valid);
  EXPECT_EQ(star.entry(kFar)->sequence, 50u);
  EXPECT_EQ(star.entry(kSource)->sequence, before);
  EXPECT_FALSE(star.entry(make_host(400))) << "no entry is made of an error";
}

TEST(Errors, A7_3_RoutesThatNobodyElseReliesOnAreNotAnnounced) {
  Star star;
  star.give_route(star.b, kFar);
  star.lose(star.b);
  EXPECT_FALSE(star.route(kFar));
  EXPECT_EQ(star.count(FrameType::kRouteError), 0u);
}

TEST(Errors, A7_3_AnErrorLeavesOutRoutesThatNobodyElseReliesOn) {
  Star star;
  star.give_route(star.b, kSource);
  star.open_way(star.b, kFar);
  star.lose(star.b);
  EXPECT_FALSE(star.route(kSource));
  EXPECT_EQ(star.announced(), (std::set<MacAddress>{kFar.address, star.b.address}));
}

TEST(Errors, A7_4_ManyPrecursorsAreToldByOneBroadcast) {
  Star star;
  for (std::size_t number = 10; number < 16; ++number) star.neighbor(number);
  star.run_for(50ms);
  for (std::size_t number = 10; number < 16; ++number) {
    star.say(star.neighbor(number), request_for(star.b, star.neighbor(number)));
  }
  star.run_for(5ms);
  star.lose(star.b);
  const auto errors = star.sent<wire::RouteError>();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].to, wire::kEverybody);
}

/// Up to eleven frames went to each robot that had driven away.
TEST(Errors, A7_4_ASilentPrecursorIsNotTold) {
  Star star;
  Host& gone = star.neighbor(4);
  for (Host* precursor : {&star.a, &gone}) {
    star.say(*precursor, request_for(kFar, *precursor));
    star.say(star.b, reply_about(kFar, *precursor), star.self().address);
    star.run_for(5ms);
  }
  gone.beacons = gone.acknowledges = false;
  star.run_for(1200ms);
  star.forget();
  star.say(star.b, error_about({{kFar, 50}}));
  star.run_for(300ms);
  const auto errors = star.sent<wire::RouteError>();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].to, star.a.address);
}

TEST(Errors, A7_5_ALostRouteIsKeptInvalidWithItsNumberRaised) {
  Star star;
  Host far = kFar;
  far.sequence = 40;
  star.open_way(star.b, far);
  star.forget();
  star.b.boot_id[0] ^= 1;  // the link to the former run is gone as soon as that does not answer
  star.beacon(star.b);
  while (star.entry(far)->valid && star.now() < 5s) star.run_for(1ms);
  const Time lost = star.now();
  EXPECT_FALSE(star.entry(far)->valid);
  EXPECT_EQ(star.entry(far)->sequence, 41u);
  EXPECT_GT(star.entry(far)->expires, lost + robot_timings().delete_period - 1ms);
  EXPECT_LE(star.entry(far)->expires, lost + robot_timings().delete_period);
  star.run_for(5ms);
  const auto errors = star.sent<wire::RouteError>();
  for (const auto& destination : errors.at(0).message.destinations) {
    if (destination.address == far.address) EXPECT_EQ(destination.sequence, 41u);
  }
}

/// Each frame for a route lost before would raise the number past what the destination itself has.
TEST(Errors, A7_5_DataForALostRouteIsAnsweredWithTheNumberRaisedOnce) {
  Star star;
  Host far = kFar;
  far.sequence = 40;
  star.open_way(star.b, far);
  star.say(star.b, error_about({{far, 41}}));
  star.run_for(5ms);
  for (std::uint32_t packet = 1; packet <= 3; ++packet) {
    star.forget();
    star.say(star.a, data_for(far, kSource, packet), star.self().address);
    star.run_for(5ms);
    const auto errors = star.sent<wire::RouteError>();
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_FALSE(errors[0].message.unknown_sequence);
    EXPECT_EQ(errors[0].message.destinations[0].sequence, 41u);
  }
}

TEST(Errors, A7_6_AnErrorWithAnOldNumberIsIgnored) {
  Star star;
  Host far = kFar;
  far.sequence = 10;
  star.open_way(star.b, far);
  star.forget();
  star.say(star.b, error_about({{far, 9}}));
  star.run_for(5ms);
  EXPECT_TRUE(star.route(far));
  EXPECT_EQ(star.entry(far)->sequence, 10u);
  EXPECT_EQ(star.count(FrameType::kRouteError), 0u);
}

/// Otherwise a longer route with that number could come, by way of robots that still rely on the lost one.
TEST(Errors, A7_5_A13_2_AnErrorWithTheStoredNumberRaisesIt) {
  Star star;
  Host far = kFar;
  far.sequence = 10;
  star.open_way(star.b, far);
  star.forget();
  star.say(star.b, error_about({{far, 10}}));
  star.run_for(5ms);
  EXPECT_FALSE(star.route(far));
  EXPECT_EQ(star.sent<wire::RouteError>().at(0).message.destinations[0].sequence, 11u);
  star.give_route(star.c, far, 9);
  EXPECT_FALSE(star.route(far));
}

TEST(Errors, A7_6_ANumberThatIsNotKnownRaisesTheOwnOne) {
  Star star;
  Host far = kFar;
  far.sequence = 10;
  star.open_way(star.b, far);
  wire::RouteError error = error_about({{far, 0}});
  error.unknown_sequence = true;
  star.say(star.b, error);
  EXPECT_FALSE(star.route(far));
  EXPECT_EQ(star.entry(far)->sequence, 11u);
}

TEST(Errors, A7_7_InvalidEntriesAreKeptForDeletePeriod) {
  for (const Timings& timings : {rfc3561_timings(), robot_timings()}) {
    EngineOptions options;
    options.timings = timings;
    Star star(options);
    star.give_route(star.b, kFar);
    star.say(star.b, error_about({{kFar, 9}}));
    star.run_for(timings.delete_period - 100ms);
    EXPECT_TRUE(star.entry(kFar));
    star.run_for(1200ms);  // tables are looked through with the beacons, once a second when nothing happens
    EXPECT_FALSE(star.entry(kFar));
  }
}

TEST(Errors, A7_7_DataForAnInvalidEntryKeepsItLonger) {
  Star star;
  star.give_route(star.b, kFar);
  star.say(star.b, error_about({{kFar, 9}}));
  star.run_for(robot_timings().delete_period - 1s);
  star.say(star.a, data_for(kFar, kSource), star.self().address);
  EXPECT_EQ(star.entry(kFar)->expires, star.now() + robot_timings().delete_period);
}

TEST(Errors, A7_8_ARouteThatRunsOutIsKeptInvalidWithItsNumberRaised) {
  Star star;
  Host far = kFar;
  far.sequence = 40;
  star.give_route(star.b, far, 2, 5s);
  star.run_for(5s - 1ms);
  EXPECT_TRUE(star.route(far));
  star.run_for(1100ms);
  ASSERT_TRUE(star.entry(far));
  EXPECT_FALSE(star.entry(far)->valid);
  EXPECT_EQ(star.entry(far)->sequence, 41u);
}

TEST(Errors, A7_9_ErrorsAreLimitedInRate) {
  EngineOptions slower;
  slower.timings.error_rate_limit = 4;
  for (const auto& [options, limit] : {std::pair(EngineOptions{}, 10u), std::pair(slower, 4u)}) {
    Star star(options);
    for (std::uint32_t packet = 0; packet < 1000; ++packet) {
      star.say(star.a, data_for(kFar, kSource, packet), star.self().address);
      star.run_for(2ms);
    }
    const auto errors = star.sent<wire::RouteError>();
    ASSERT_EQ(errors.size(), 2 * limit);
    for (std::size_t i = limit; i < errors.size(); ++i) EXPECT_GE(errors[i].at - errors[i - limit].at, 1s);
  }
}

TEST(Errors, A7_9_CopiesOfOneErrorCountOnce) {
  EngineOptions options;
  options.timings.error_rate_limit = 1;
  Star star(options);
  for (Host* asker : {&star.a, &star.c}) star.say(*asker, request_for(star.b, *asker));
  star.run_for(5ms);
  star.lose(star.b);
  EXPECT_EQ(star.sent<wire::RouteError>().size(), 2u);
}

TEST(Errors, A7_11_NewsOfARepairIsPassedOnWithoutDeletingTheRoute) {
  Star star;
  star.open_way(star.b, kFar);
  star.forget();
  wire::RouteError error = error_about({{kFar, 9}});
  error.no_delete = true;
  star.say(star.c, error);
  star.run_for(5ms);
  EXPECT_EQ(star.count(FrameType::kRouteError), 0u) << "from a robot that is not the next hop";
  star.say(star.b, error);
  star.run_for(5ms);
  const auto errors = star.sent<wire::RouteError>();
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].to, star.a.address);
  EXPECT_TRUE(errors[0].message.no_delete);
  EXPECT_TRUE(star.route(kFar));
}

TEST(Errors, A7_11_NewsOfARepairEndsWhereNobodyReliesOnTheRoute) {
  Star star;
  star.give_route(star.b, kFar);
  wire::RouteError error = error_about({{kFar, 9}});
  error.no_delete = true;
  star.say(star.b, error);
  star.run_for(5ms);
  EXPECT_EQ(star.count(FrameType::kRouteError), 0u);
}

TEST(Errors, A1_4_A7_12_ManyDestinationsAreSplitAndNoneIsLeftOut) {
  Star star;
  std::set<MacAddress> over_b{star.b.address};
  for (std::size_t i = 0; i < 400; ++i) {
    const Host destination = make_host(1000 + i);
    star.say(star.a, request_for(destination, star.a, ++star.id));
    star.say(star.b, reply_about(destination, star.a), star.self().address);
    over_b.insert(destination.address);
    if (i % 50 == 0) star.run_for(5ms);
  }
  star.run_for(100ms);
  star.lose(star.b);
  const auto errors = star.sent<wire::RouteError>();
  EXPECT_EQ(star.announced(), over_b);
  for (const auto& error : errors) EXPECT_LE(error.message.destinations.size(), 30u);
  ASSERT_GT(errors.size(), 10u);
  for (std::size_t i = 10; i < errors.size(); ++i) EXPECT_GE(errors[i].at - errors[i - 10].at, 1s);
}

TEST(Errors, A7_12_WhatWorksAgainIsNotAnnouncedLate) {
  EngineOptions options;
  options.timings.error_rate_limit = 1;
  Star star(options);
  for (std::size_t i = 0; i < 40; ++i) star.open_way(star.b, make_host(1000 + i));
  star.lose(star.c);
  star.forget();
  star.b.boot_id[0] ^= 1;
  star.beacon(star.b);
  while (star.announced().empty() && star.now() < 10s) star.run_for(5ms);
  const std::set<MacAddress> first = star.announced();
  EXPECT_EQ(first.size(), 30u);
  Host again = make_host(1000);
  while (first.count(again.address) != 0) again = make_host(std::size_t{again.address[4]} * 256 + again.address[5] + 1);
  again.sequence = 10;
  star.give_route(star.a, again);
  star.run_for(2s);
  EXPECT_EQ(star.announced().count(again.address), 0u);
  EXPECT_GE(star.announced().size(), 39u);
}

}  // namespace
}  // namespace adhoc_communication
