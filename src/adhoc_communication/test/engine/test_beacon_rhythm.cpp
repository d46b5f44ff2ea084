// Beacons are rare while nothing happens, and soon when something does.
#include <gtest/gtest.h>

#include "presence/beacon_rhythm.hpp"

namespace adhoc_communication::presence {
namespace {

using namespace std::chrono_literals;

TEST(BeaconRhythm, BacksOffWhileNothingHappens) {
  Random random(1);
  BeaconRhythm rhythm(100ms, random, 0s);
  EXPECT_EQ(rhythm.due(), 0s) << "the first at once";
  EXPECT_EQ(rhythm.next(0s), 100ms);
  EXPECT_GE(rhythm.due(), 95ms);
  EXPECT_LE(rhythm.due(), 105ms);
  EXPECT_EQ(rhythm.next(BeaconRhythm::kQuiet), 200ms);
  EXPECT_EQ(rhythm.next(2s), 400ms);
  EXPECT_EQ(rhythm.next(3s), 800ms);
  EXPECT_EQ(rhythm.next(4s), BeaconRhythm::kIdleInterval);
  EXPECT_EQ(rhythm.next(5s), BeaconRhythm::kIdleInterval);
}

TEST(BeaconRhythm, SomethingThatHappensMakesThemFrequentAgain) {
  Random random(1);
  BeaconRhythm rhythm(100ms, random, 0s);
  for (const Time now : {2s, 3s, 4s, 5s, 6s}) rhythm.next(now);
  ASSERT_GT(rhythm.due(), 6900ms);
  rhythm.happened(6100ms);
  EXPECT_LE(rhythm.due(), 6200ms);
  EXPECT_EQ(rhythm.next(6200ms), 100ms);
}

TEST(BeaconRhythm, NewcomersAreGreetedButNotRightAfterABeacon) {
  Random random(1);
  BeaconRhythm rhythm(1s, random, 0s);
  rhythm.next(0s);
  rhythm.greet(1ms);
  EXPECT_EQ(rhythm.due(), BeaconRhythm::kGreetingPause);
  rhythm.next(1s);
  rhythm.greet(1500ms);
  EXPECT_LE(rhythm.due(), 1500ms + BeaconRhythm::kGreeting);
}

}  // namespace
}  // namespace adhoc_communication::presence
