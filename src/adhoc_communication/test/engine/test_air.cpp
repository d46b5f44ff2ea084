// What frames of each kind cost.
#include <gtest/gtest.h>

#include <algorithm>

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

}  // namespace
}  // namespace adhoc_communication
