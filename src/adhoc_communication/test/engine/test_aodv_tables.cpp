// Routing table and precursors: A3 of docs/aodv.md.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "routing/route_table.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using routing::kPerfectHop;

TEST(Tables, A3_1_AnEntryTellsAllThatIsKeptOfARoute) {
  Stage stage;
  Host& a = stage.neighbor(1);
  Host& b = stage.neighbor(2);
  stage.run_for(10ms);
  Host far = kFar;
  far.sequence = 40;
  stage.say(a, request_for(far, a));
  wire::RouteReply reply = reply_about(far, a);
  reply.hop_count = 2;
  reply.cost = 40;
  reply.lifetime_ms = 7000;
  const Time told = stage.now();
  stage.say(b, reply, stage.self().address);
  stage.run_for(10ms);
  const auto entry = stage.entry(far);
  ASSERT_TRUE(entry);
  EXPECT_EQ(entry->sequence, 40u);
  EXPECT_TRUE(entry->sequence_valid);
  EXPECT_TRUE(entry->valid);
  EXPECT_FALSE(entry->repairable);
  EXPECT_EQ(entry->hops, 3);
  EXPECT_EQ(entry->cost, 3.5);
  EXPECT_EQ(entry->next_hop, b.address);
  EXPECT_EQ(entry->boot, far.boot());
  EXPECT_EQ(entry->expires, told + 7s);
  EXPECT_EQ(entry->precursors, std::vector<MacAddress>{a.address});
  b.beacons = b.acknowledges = false;
  stage.run_for(3s);
  EXPECT_FALSE(stage.entry(far)->valid);
  EXPECT_TRUE(stage.entry(far)->repairable);
}

/// Whether news with this number and cost replaces an entry with number 100 and a cost of three hops.
bool replaces(std::optional<std::uint32_t> number, int hops, bool stored_number = true) {
  const Timings timings = robot_timings();
  routing::RouteTable table(timings);
  const auto offer = [](std::optional<std::uint32_t> sequence, int length, std::size_t via) {
    return routing::RouteOffer{kFar.address,
                               5,
                               sequence,
                               static_cast<std::uint8_t>(length),
                               static_cast<routing::Cost>(length * kPerfectHop),
                               make_host(via).address,
                               10s};
  };
  table.update(offer(stored_number ? std::optional<std::uint32_t>(100) : std::nullopt, 3, 1));
  const bool updated = table.update(offer(number, hops, 2));
  EXPECT_EQ(table.find(kFar.address)->next_hop, make_host(updated ? 2 : 1).address);
  return updated;
}

TEST(Tables, A3_2_OnlyNewerOrAsNewAndCheaperNewsReplacesARoute) {
  for (const int hops : {2, 3, 4}) {
    EXPECT_TRUE(replaces(101, hops)) << hops;
    EXPECT_EQ(replaces(100, hops), hops < 3) << hops;
    EXPECT_FALSE(replaces(99, hops)) << hops;
    EXPECT_FALSE(replaces(std::nullopt, hops)) << hops;
    EXPECT_TRUE(replaces(1, hops, false)) << hops << ", the stored number unknown";
  }
}

/// Numbers of another run of the destination say nothing about the stored one.
TEST(Tables, A3_2_AnotherRunStartsAnew) {
  const Timings timings = robot_timings();
  routing::RouteTable table(timings);
  table.update({kFar.address, 5, 100, 1, kPerfectHop, make_host(1).address, 10s});
  EXPECT_TRUE(table.update({kFar.address, 6, 1, 4, 4 * kPerfectHop, make_host(2).address, 10s}));
  EXPECT_EQ(table.find(kFar.address)->sequence, 1u);
}

/// Source - A - node - B - destination.
struct Relay : Stage {
  explicit Relay(EngineOptions options = {}) : Stage(std::move(options)), a(neighbor(1)), b(neighbor(2)) {
    run_for(10ms);
    wire::RouteRequest request = request_for(kFar, kSource);
    request.hop_count = 1;
    say(a, request);
    wire::RouteReply reply = reply_about(kFar, kSource);
    reply.hop_count = 1;
    say(b, reply, self().address);
    run_for(10ms);
    forget();
  }
  Host& a;
  Host& b;
};

TEST(Tables, A3_3_DataKeepsTheWholeWayAlive) {
  Relay relay;
  const Time timeout = robot_timings().active_route_timeout;
  relay.a.beacons = relay.b.beacons = false;  // they would do it by themselves
  relay.acknowledge(relay.a);
  for (std::uint32_t packet = 1; packet <= 5; ++packet) {
    relay.run_for(1s);
    relay.acknowledge(relay.a);
    relay.say(relay.a, data_for(kFar, kSource, packet), relay.self().address);
    for (const Host& host : {kSource, relay.a, relay.b, kFar}) {
      ASSERT_TRUE(relay.route(host)) << host.name;
      EXPECT_GE(relay.route(host)->expires, relay.now() + timeout) << host.name << " with packet " << packet;
    }
  }
  relay.run_for(10ms);
  EXPECT_EQ(relay.sent<wire::Data>().size(), 5u);
}

TEST(Tables, A3_3_A7_8_RoutesInUseOutliveTheirTimeoutAndIdleOnesDoNot) {
  Relay relay;
  const Time timeout = robot_timings().active_route_timeout;
  for (std::uint32_t packet = 1; packet <= 5; ++packet) {
    relay.run_for(timeout * 9 / 10);
    relay.say(relay.a, data_for(kFar, kSource, packet), relay.self().address);
  }
  relay.run_for(10ms);
  EXPECT_EQ(relay.sent<wire::Data>().size(), 5u);
  EXPECT_TRUE(relay.requests().empty());
  const std::uint32_t before = relay.entry(kFar)->sequence;
  relay.run_for(timeout - 20ms);
  EXPECT_TRUE(relay.route(kFar) && relay.route(kSource));
  relay.run_for(20ms);
  EXPECT_FALSE(relay.route(kFar) || relay.route(kSource));
  relay.run_for(1100ms);
  EXPECT_EQ(relay.entry(kFar)->sequence, before + 1) << "kept, its number raised";
}

TEST(Tables, A3_4_A7_4_WhoAskedForARouteIsToldOfItsLoss) {
  Stage stage;
  std::vector<MacAddress> askers;
  for (std::size_t number = 1; number <= 3; ++number) askers.push_back(stage.neighbor(number).address);
  stage.neighbor(4);
  Host& d = stage.neighbor(5);
  stage.run_for(10ms);
  for (std::size_t number = 1; number <= 3; ++number)
    stage.say(stage.neighbor(number), request_for(d, stage.neighbor(number)));
  stage.run_for(10ms);
  EXPECT_EQ(stage.sent<wire::RouteReply>().size(), 3u);
  EXPECT_EQ(stage.entry(d)->precursors, askers);
  d.beacons = d.acknowledges = false;
  stage.run_for(3s);
  std::vector<MacAddress> told;
  for (const auto& error : stage.sent<wire::RouteError>()) {
    EXPECT_EQ(error.message.destinations.at(0).address, d.address);
    told.push_back(error.to);
  }
  std::sort(told.begin(), told.end());
  EXPECT_EQ(told, askers);
}

}  // namespace
}  // namespace adhoc_communication
