// Who gets a copy of a route request of his own.
#include <gtest/gtest.h>

#include <optional>
#include <set>

#include "host.hpp"
#include "routing/request_flood.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

/// A robot that passes a request on while its neighbours are silent, and to whom it gives copies then.
class RequestCopies : public testing::Test, public Outbox {
 protected:
  void broadcast(wire::FrameType, Bytes, Time) override { ++broadcasts; }
  void unicast(const MacAddress& to, wire::FrameType, Bytes) override { copies.insert(to); }
  void unicast_once(const MacAddress&, wire::FrameType, Bytes, Time) override {}

  /// It hears this robot's beacons with that loss, and perhaps those of another one.
  void meet(const Host& neighbor, double loss, double loss_of_other = 0.0, const std::optional<Host>& other = {}) {
    wire::Beacon beacon;
    beacon.number = 1;
    beacon.name = neighbor.name;
    beacon.heard.push_back({wire::neighbor_tag(kSelf), static_cast<std::uint8_t>(loss * 255)});
    if (other)
      beacon.heard.push_back({wire::neighbor_tag(boot_of(*other)), static_cast<std::uint8_t>(loss_of_other * 255)});
    neighbors.heard(neighbor.address, boot_of(neighbor), 1s);
    neighbors.beacon(neighbor.address, beacon, wire::neighbor_tag(kSelf), 1s);
  }

  /// From `source`, of one who is not in range, with so many hops to go behind this robot.
  void pass_on(std::uint8_t hop_limit, const MacAddress& destination, const Host& source, int expected = 1) {
    wire::RouteRequest request = request_for({}, make_host(50), 1);
    request.destination = destination;
    request.hop_count = 1;
    request.hop_limit = hop_limit;
    routing::RequestFlood flood(timings, hops_acknowledge, *this, random);
    ASSERT_TRUE(flood.first_time(request, source.address, 1s));
    flood.forward(request, routing::kPerfectHop, 1s);
    for (Time now = 1s; now < 1100ms; now += 1ms) flood.poll(neighbors, now);
    ASSERT_EQ(broadcasts, expected);
  }

  static wire::BootTag boot_of(const Host& host) { return wire::boot_tag(host.boot_id); }

  static constexpr wire::BootTag kSelf = 77;
  const MacAddress far_away = make_host(60).address;
  const Timings timings = robot_timings();
  Random random{1};
  routing::Neighbors neighbors{timings, 250ms};
  bool hops_acknowledge = true;
  int broadcasts = 0;
  std::set<MacAddress> copies;
};

TEST_F(RequestCopies, GoToASilentNeighbourThatHearsNobodyElse) {
  const Host source = make_host(1);
  const Host silent = make_host(2);
  meet(source, 0.0);
  meet(silent, 0.1);
  pass_on(5, far_away, source);
  EXPECT_EQ(copies, std::set{silent.address});
}

/// In a crowd 97 % of the copies went to robots that had the request and did not pass it on: they had it from several,
/// or it was not to go any farther.
TEST_F(RequestCopies, NoneForWhoIsSilentSinceHeHasItFromTwo) {
  const Host source = make_host(1);
  const Host well = make_host(2);
  const Host badly = make_host(3);
  meet(source, 0.0);
  meet(well, 0.1, 0.5, source);
  meet(badly, 0.4, 0.5, source);
  pass_on(5, far_away, source);
  EXPECT_EQ(copies, std::set{badly.address}) << "it has missed both with a probability of 0.2, the other one of 0.05";
}

/// On the move most copies went over links that were fading already, to robots that others had reached.
TEST_F(RequestCopies, NoneForWhoHearsTwoOthersThatHearThisRobot) {
  const Host source = make_host(1);
  const Host silent = make_host(2);
  const Host third = make_host(3);
  const Host fourth = make_host(4);
  meet(source, 0.0);
  meet(third, 0.1);
  meet(silent, 0.2, 0.4, third);
  pass_on(5, far_away, source);
  EXPECT_EQ(copies, (std::set{silent.address, third.address})) << "one other";
  copies.clear();
  broadcasts = 0;
  meet(fourth, 0.1);
  meet(silent, 0.2, 0.4, fourth);
  pass_on(5, far_away, source);
  EXPECT_EQ(copies, (std::set{third.address, fourth.address})) << "two others";
}

TEST_F(RequestCopies, ABroadcastIsForOneWithTwoOtherWaysAsWell) {
  const Host source = make_host(1);
  const Host next = make_host(2);
  meet(source, 0.0);
  for (const Host& other : {make_host(3), make_host(4)}) {
    meet(other, 0.1, 0.0, source);
    meet(next, 0.2, 0.2, other);
  }
  pass_on(5, far_away, source, 1);
  EXPECT_TRUE(copies.empty());
}

TEST_F(RequestCopies, AtTheLastHopForTheDestinationOnly) {
  const Host source = make_host(1);
  const Host destination = make_host(2);
  const Host other = make_host(3);
  meet(source, 0.0);
  meet(destination, 0.2);
  meet(other, 0.2);
  pass_on(1, destination.address, source);
  EXPECT_EQ(copies, std::set{destination.address});
}

TEST_F(RequestCopies, AtTheLastHopForAllWhenAskedForByName) {
  const Host source = make_host(1);
  const Host silent = make_host(2);
  const Host another = make_host(3);
  meet(source, 0.0);
  meet(silent, 0.2);
  meet(another, 0.2);
  pass_on(1, {}, source);
  EXPECT_EQ(copies, (std::set{silent.address, another.address}));
}

/// Who has it from nobody else waited 25 to 35 ms at each hop that lost the broadcast.
TEST_F(RequestCopies, InPlaceOfABroadcastForOneThatMayMissIt) {
  const Host source = make_host(1);
  const Host next = make_host(2);
  meet(source, 0.0);
  meet(next, 0.2);
  // Where hops do not acknowledge, a broadcast and a copy are two chances.
  for (const bool acknowledge : {true, false}) {
    hops_acknowledge = acknowledge;
    copies.clear();
    pass_on(5, far_away, source, acknowledge ? 0 : 1);
    EXPECT_EQ(copies, std::set{next.address});
  }
}

TEST_F(RequestCopies, ABroadcastThatIsHardlyLostIsForOneAsWell) {
  const Host source = make_host(1);
  meet(source, 0.0);
  meet(make_host(2), 0.05);
  pass_on(5, far_away, source, 1);
}

/// Requests are kept waiting for those over better links only where there can be others.
TEST_F(RequestCopies, KnowsWhetherThereIsAnotherWay) {
  const Host source = make_host(1);
  const Host next = make_host(2);
  const Host third = make_host(3);
  const auto bypassed = [&] { return neighbors.bypassed(source.address, wire::neighbor_tag(kSelf), 1s); };
  meet(source, 0.3);
  meet(next, 0.3);
  EXPECT_FALSE(bypassed());
  meet(next, 0.3, 0.3, third);
  EXPECT_FALSE(bypassed()) << "a third robot, which the source does not hear";
  meet(source, 0.3, 0.3, third);
  EXPECT_TRUE(bypassed()) << "by way of the third robot";
}

TEST_F(RequestCopies, ANeighbourThatHearsTheSenderItselfIsAnotherWay) {
  const Host source = make_host(1);
  meet(source, 0.3);
  meet(make_host(2), 0.3, 0.3, source);
  EXPECT_TRUE(neighbors.bypassed(source.address, wire::neighbor_tag(kSelf), 1s));
}

}  // namespace
}  // namespace adhoc_communication
