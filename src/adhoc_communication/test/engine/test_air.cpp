// What frames of each kind cost, and what follows from that.
#include <gtest/gtest.h>

#include <algorithm>

#include "payloads.hpp"
#include "routing/link_layer.hpp"
#include "simulation/team.hpp"
#include "transport/air_clock.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kOctets = 1500;
const MacAddress kNear{{2, 1}};
const MacAddress kFar{{2, 2}};
const MacAddress kUnknown{{2, 3}};

double microseconds(Time time) { return static_cast<double>(time.count()) * 1e-3; }

double frame_time(const transport::AirClock& clock, const MacAddress& to) {
  return microseconds(clock.rate(to).air_time(kOctets));
}

/// A pair of frames that arrive `duration` apart.
void measure(transport::AirClock& clock, std::uint64_t& counter, const MacAddress& to, Time duration, Time now) {
  clock.transmitted(++counter, kOctets, to, now);
  clock.transmitted(++counter, kOctets, to, now);
  clock.acknowledged_late(counter, duration, now + 2 * duration);
}

TEST(AirClockKinds, EachNeighborAndBroadcastsHaveTheirRate) {
  transport::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) {
    measure(clock, counter, kNear, 400us, i * 100ms);
    measure(clock, counter, kFar, 2ms, i * 100ms + 30ms);
    measure(clock, counter, wire::kEverybody, 12ms, i * 100ms + 50ms);
  }
  EXPECT_NEAR(frame_time(clock, kNear), 400, 1);
  EXPECT_NEAR(frame_time(clock, kFar), 2000, 1);
  EXPECT_NEAR(frame_time(clock, wire::kEverybody), 12'000, 1);
  for (const MacAddress& to : {kNear, kFar, wire::kEverybody}) EXPECT_TRUE(clock.calibrated(to));
  const Time now = 10s;
  clock.transmitted(++counter, kOctets, kNear, now);
  EXPECT_NEAR(microseconds(clock.idle_at() - now), 400, 1) << "paced by the rate of its receiver";
}

TEST(AirClockKinds, OneNeverMeasuredIsBelievedToBeLikeTheOthers) {
  transport::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) measure(clock, counter, kNear, 400us, i * 100ms);
  EXPECT_NEAR(frame_time(clock, kUnknown), 400, 1);
  EXPECT_TRUE(clock.calibrated(kUnknown));
  EXPECT_FALSE(clock.calibrated(wire::kEverybody)) << "frames for everybody are measured at once";
}

TEST(AirClockKinds, ABoundAloneDoesNotMakeAKindKnown) {
  transport::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) measure(clock, counter, kNear, 400us, i * 100ms);
  clock.transmitted(++counter, kOctets, kUnknown, 10s);
  clock.acknowledged(counter, 0ms, 10s + 5ms);
  EXPECT_NEAR(frame_time(clock, kUnknown), 400, 1);
}

TEST(AirClockKinds, NeighborsThatAreGoneAreForgotten) {
  transport::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  measure(clock, counter, kNear, 400us, 0ms);
  measure(clock, counter, kFar, 2ms, 50ms);
  measure(clock, counter, wire::kEverybody, 12ms, 100ms);
  clock.forget_unless([](const MacAddress& neighbor) { return neighbor == kFar; });
  EXPECT_GT(frame_time(clock, kNear), 450) << "believed to be like all";
  EXPECT_NEAR(frame_time(clock, kFar), 2000, 1);
  EXPECT_NEAR(frame_time(clock, wire::kEverybody), 12'000, 1);
}

TEST(LinkLayer, IsKnownByTheLossThatItHides) {
  routing::LinkLayer silent;
  for (int i = 0; i < 1000; ++i) silent.compare(0.0, 0.0);
  EXPECT_FALSE(silent.repeats()) << "no loss, no evidence";
  routing::LinkLayer repeating;
  for (int i = 0; i < 100; ++i) repeating.compare(0.2, 0.01);
  EXPECT_TRUE(repeating.repeats());
  for (int i = 0; i < 500; ++i) repeating.compare(0.2, 0.2);
  EXPECT_FALSE(repeating.repeats());
}

/// Robot 0 sends packets to robot 1; the hop ARQ sees what the link layer has left of the loss, beacons see all of it.
double loss_of_used_link(int unicast_retries) {
  MediumOptions medium;
  medium.contention = true;
  medium.loss = 0.3;
  medium.rates.unicast_retries = unicast_retries;
  Team team(medium, 1);
  team.add_line(2);
  for (int i = 0; i < 120; ++i) {
    team.send(0, Team::name(1), noise(5000, static_cast<std::uint64_t>(i)));
    team.run_for(500ms);
  }
  const std::vector<LinkState> links = team.engine(0).links();
  return links.at(0).loss;
}

TEST(LinkLayer, CostsAreThoseOfBeaconsWhereItRepeats) {
  EXPECT_NEAR(loss_of_used_link(0), 0.3, 0.2);
  EXPECT_GT(loss_of_used_link(7), 0.05) << "not the zero that its retries leave";
}

}  // namespace
}  // namespace adhoc_communication
