// What frames of each kind cost, and what follows from that.
#include <gtest/gtest.h>

#include <algorithm>

#include "air/air_clock.hpp"
#include "multicast/carriage.hpp"
#include "payloads.hpp"
#include "routing/link_layer.hpp"
#include "simulation/team.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using multicast::Way;

constexpr std::size_t kOctets = 1500;
const MacAddress kNear{{2, 1}};
const MacAddress kFarOff{{2, 2}};
const MacAddress kUnknown{{2, 3}};

double microseconds(Time time) { return static_cast<double>(time.count()) * 1e-3; }

double frame_time(const air::AirClock& clock, const MacAddress& to) {
  return microseconds(clock.rate(to).air_time(kOctets));
}

/// A pair of frames that arrive `duration` apart.
void measure(air::AirClock& clock, std::uint64_t& counter, const MacAddress& to, Time duration, Time now) {
  clock.transmitted(++counter, kOctets, to, now);
  clock.transmitted(++counter, kOctets, to, now);
  clock.acknowledged_late(counter, duration, now + 2 * duration);
}

TEST(AirClockKinds, EachNeighborAndBroadcastsHaveTheirRate) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) {
    measure(clock, counter, kNear, 400us, i * 100ms);
    measure(clock, counter, kFarOff, 2ms, i * 100ms + 30ms);
    measure(clock, counter, wire::kEverybody, 12ms, i * 100ms + 50ms);
  }
  EXPECT_NEAR(frame_time(clock, kNear), 400, 1);
  EXPECT_NEAR(frame_time(clock, kFarOff), 2000, 1);
  EXPECT_NEAR(frame_time(clock, wire::kEverybody), 12'000, 1);
  for (const MacAddress& to : {kNear, kFarOff, wire::kEverybody}) EXPECT_TRUE(clock.calibrated(to));
  const Time now = 10s;
  clock.transmitted(++counter, kOctets, kNear, now);
  EXPECT_NEAR(microseconds(clock.idle_at() - now), 400, 1) << "paced by the rate of its receiver";
}

TEST(AirClockKinds, OneNeverMeasuredIsBelievedToBeLikeTheOthers) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) measure(clock, counter, kNear, 400us, i * 100ms);
  EXPECT_NEAR(frame_time(clock, kUnknown), 400, 1);
  EXPECT_TRUE(clock.calibrated(kUnknown));
  EXPECT_FALSE(clock.calibrated(wire::kEverybody)) << "frames for everybody are measured at once";
}

TEST(AirClockKinds, ABoundAloneDoesNotMakeAKindKnown) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) measure(clock, counter, kNear, 400us, i * 100ms);
  clock.transmitted(++counter, kOctets, kUnknown, 10s);
  clock.acknowledged(counter, 0ms, 10s + 5ms, 0);
  EXPECT_NEAR(frame_time(clock, kUnknown), 400, 1);
}

TEST(AirClockKinds, NeighborsThatAreGoneAreForgotten) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  measure(clock, counter, kNear, 400us, 0ms);
  measure(clock, counter, kFarOff, 2ms, 50ms);
  measure(clock, counter, wire::kEverybody, 12ms, 100ms);
  clock.forget_unless([](const MacAddress& neighbor) { return neighbor == kFarOff; });
  EXPECT_GT(frame_time(clock, kNear), 450) << "believed to be like all";
  EXPECT_NEAR(frame_time(clock, kFarOff), 2000, 1);
  EXPECT_NEAR(frame_time(clock, wire::kEverybody), 12'000, 1);
}

/// A neighbour that reported seconds kept the radio from sending to all others.
TEST(AirClockKinds, WhatANeighborReportsIsNoLongerThanItCanBe) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 10; ++i) {
    const Time now = i * 100ms;
    clock.transmitted(++counter, kOctets, kNear, now);
    clock.transmitted(++counter, kOctets, kNear, now);
    clock.acknowledged(counter, 4s, now + 3ms, 0);
  }
  EXPECT_LE(frame_time(clock, kNear), 3000) << "it was answered within that";
  for (int i = 10; i < 40; ++i) {
    const Time now = i * 100ms;
    clock.transmitted(++counter, kOctets, kFarOff, now);
    clock.transmitted(++counter, kOctets, kFarOff, now);
    clock.acknowledged(counter, 4s, now + 90ms, 0);
  }
  const double slowest = microseconds(air::AirRate::slowest_air_time(kOctets));
  EXPECT_LE(frame_time(clock, kFarOff), slowest + 1);
  EXPECT_LE(frame_time(clock, kUnknown), slowest + 1);
  EXPECT_LT(slowest, 15'000);
}

TEST(AirClockKinds, AnAnswerThatComesAfterLaterOnesStillMeasures) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (const MacAddress& peer : {kNear, kNear, kFarOff, kFarOff}) clock.transmitted(++counter, kOctets, peer, 0ms);
  clock.acknowledged_late(4, 2ms, 6ms);
  clock.acknowledged_late(2, 400us, 7ms);
  ASSERT_NE(clock.measured(kNear), nullptr);
  EXPECT_NEAR(microseconds(clock.undisturbed_frame_time(kNear)), 400, 1);
  clock.acknowledged_late(2, 100us, 8ms);
  EXPECT_NEAR(microseconds(clock.undisturbed_frame_time(kNear)), 400, 1) << "each frame measures once";
}

/// Half a frame ahead, a radio that repeats frames by itself stood idle after each that it did not have to repeat.
TEST(AirClockKinds, ARadioThatTakesNowLongerNowLessLongIsKeptBusy) {
  const auto ahead = [](Time shorter, Time longer) {
    air::AirClock clock(kOctets);
    std::uint64_t counter = 0;
    for (int i = 0; i < 60; ++i) measure(clock, counter, kNear, i % 2 == 0 ? shorter : longer, i * 100ms);
    clock.transmitted(++counter, kOctets, kNear, 10s);
    return microseconds(clock.idle_at() - clock.ready_at()) / frame_time(clock, kNear);
  };
  EXPECT_NEAR(ahead(1ms, 1ms), 0.5, 0.01);
  EXPECT_GT(ahead(700us, 1300us), 1.5);
  EXPECT_NEAR(ahead(100us, 4ms), 4.5, 0.01) << "an urgent frame waits for no more than that";
}

TEST(AirClockKinds, WhatOthersDisturbedDoesNotCount) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (const Time duration : {Time(5ms), Time(400us), Time(3ms), Time(5ms)}) {
    measure(clock, counter, kNear, duration, counter * 50ms);
  }
  EXPECT_NEAR(microseconds(clock.undisturbed_frame_time(kNear)), 400, 1);
}

TEST(AirClockKinds, OfTheFirstMeasurementsTheShortestCounts) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  measure(clock, counter, kNear, 12ms, 0ms);
  measure(clock, counter, kNear, 400us, 100ms);
  EXPECT_NEAR(frame_time(clock, kNear), 750, 1) << "a measurement changes the estimate sixteenfold at most";
  measure(clock, counter, kNear, 400us, 200ms);
  EXPECT_NEAR(frame_time(clock, kNear), 400, 1);
}

/// Pairs that arrive `apart`, one in `every` of them together: something behind the radio holds frames back.
double frame_time_in_jitter(Time apart, int every) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  measure(clock, counter, kNear, 400us, 0ms);
  for (int i = 1; i < 40; ++i) measure(clock, counter, kNear, i % every == 0 ? Time(1) : apart, i * 100ms);
  EXPECT_EQ(clock.jittered(kNear), every < 40);
  return frame_time(clock, kNear);
}

/// Distances that jitter had stretched were taken for air time, and a radio of 50 Mbit/s was paced as one of 2.
TEST(AirClockJitter, WhereFramesArriveTogetherTheLeastDistanceCounts) {
  EXPECT_GT(frame_time_in_jitter(8ms, 1000), 7500) << "others wait for the air as well";
  EXPECT_LT(frame_time_in_jitter(8ms, 4), 500);
}

/// As where a radio aggregates frames, or a cable is faster than any radio: relays over cables lost a fifth of their
/// rate to measurements.
TEST(AirClockJitter, FramesOfAFastLinkComeTogetherWithoutIt) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 80; ++i) measure(clock, counter, kNear, i % 2 == 0 ? Time(1) : 30us, i * 100ms);
  EXPECT_FALSE(clock.jittered(kNear));
  EXPECT_LT(frame_time(clock, kNear), 60);
}

/// An urgent frame overtakes others within the radio.
TEST(AirClockJitter, FramesOfTwoQueuesTellNothing) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  measure(clock, counter, kNear, 2ms, 0ms);
  for (int i = 1; i < 40; ++i) {
    clock.transmitted(++counter, kOctets, kNear, i * 100ms);
    clock.transmitted(++counter, kOctets, kNear, i * 100ms, AccessCategory::kVoice);
    clock.acknowledged_late(counter, Time(1), i * 100ms + 4ms);
  }
  EXPECT_FALSE(clock.jittered(kNear));
}

TEST(AirClockJitter, IsNoCrowdAndMeasuredMoreOften) {
  air::AirClock clock(kOctets);
  std::uint64_t counter = 0;
  for (int i = 0; i < 40; ++i)
    measure(clock, counter, kNear, i % 2 == 0 ? Time(1) : Time((i % 9 + 1) * 1ms), i * 100ms);
  ASSERT_TRUE(clock.jittered(kNear));
  EXPECT_FALSE(clock.rate(kNear).waits_for_others());
  EXPECT_EQ(clock.pair_interval(kNear), air::AirClock::kPairIntervalInJitter);
  for (int i = 40; i < 240; ++i) measure(clock, counter, kNear, 2ms, i * 100ms);
  EXPECT_FALSE(clock.jittered(kNear)) << "it is over";
  EXPECT_NEAR(frame_time(clock, kNear), 2000, 100);
}

class CarriageTest : public ::testing::Test {
 protected:
  void know(const MacAddress& to, Time duration) {
    for (int i = 0; i < 4; ++i) measure(clock_, counter_, to, duration, now_ += 50ms);
  }
  Way way(std::size_t frames = 100) const { return carriage_.way({kNear, kFarOff}, frames, now_); }

  Timings timings_ = robot_timings();
  routing::Neighbors neighbors_{timings_, 250ms};
  air::AirClock clock_{kOctets};
  multicast::Carriage carriage_{clock_, neighbors_};
  std::uint64_t counter_ = 0;
  Time now_ = 1s;
};

TEST_F(CarriageTest, NothingIsKnown) { EXPECT_EQ(way(), Way::kBroadcast); }

TEST_F(CarriageTest, ATrialOnlyWhereItMayPay) {
  know(wire::kEverybody, 500us);
  EXPECT_EQ(way(), Way::kBroadcast) << "two unicasts cannot be cheaper";
  know(wire::kEverybody, 2ms);
  EXPECT_EQ(way(), Way::kTrial);
  EXPECT_EQ(way(multicast::Carriage::kWorthATrial - 1), Way::kBroadcast) << "not for a few frames";
}

TEST_F(CarriageTest, TheCheaperWayByTheSumOverTheReceivers) {
  know(wire::kEverybody, 2ms);
  know(kNear, 400us);
  know(kFarOff, 400us);
  EXPECT_EQ(way(), Way::kUnicasts);
  know(kFarOff, 1700us);
  EXPECT_EQ(way(), Way::kBroadcast);
  know(wire::kEverybody, 12ms);
  EXPECT_EQ(way(), Way::kUnicasts);
}

TEST_F(CarriageTest, WhatWasMeasuredLongAgoIsTriedAnew) {
  know(wire::kEverybody, 2ms);
  know(kNear, 400us);
  know(kFarOff, 400us);
  now_ += air::AirRate::kLatest;
  know(wire::kEverybody, 2ms);
  EXPECT_EQ(way(), Way::kTrial);
}

/// One that seems six times as fast as the others, as may be on a crowded channel, would have a root build trees there.
TEST_F(CarriageTest, OneFastNeighbourDoesNotMakeBroadcastsSlow) {
  know(wire::kEverybody, 2ms);
  for (std::uint8_t i = 1; i <= 3; ++i) {
    const MacAddress neighbor{2, 0, 0, 0, 1, i};
    neighbors_.heard(neighbor, i, now_);
    know(neighbor, i == 1 ? 300us : 1900us);
  }
  EXPECT_TRUE(carriage_.flood_pays(20, 10));
  for (std::uint8_t i = 2; i <= 3; ++i) know({2, 0, 0, 0, 1, i}, 300us);
  EXPECT_FALSE(carriage_.flood_pays(20, 10)) << "they are slow";
}

/// Data frames of a 200 kB packet to the group of robot 0, by themselves to a member and for everybody.
std::pair<int, int> group_frames(std::size_t members, double broadcast_rate) {
  MediumOptions medium;
  medium.contention = true;
  medium.rates.broadcast = broadcast_rate;
  medium.rates.unicast = ofdm_rates();
  medium.rates.unicast_retries = 7;
  Team team(medium, 1);
  for (std::size_t i = 0; i <= members; ++i) team.add({}, 0.1 * static_cast<double>(i), 0);
  team.run_for(8s);
  std::pair<int, int> counts{0, 0};
  team.on_transmission = [&](std::size_t, const Frame& frame) {
    if (frame.bytes[1] != static_cast<std::uint8_t>(wire::FrameType::kGroupData)) return;
    ++(frame.destination == wire::kEverybody ? counts.second : counts.first);
  };
  const Bytes payload = noise(200'000);
  const SendId id = team.send(0, "mc_robot_0", payload, Priority::kBulk);
  EXPECT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s));
  for (std::size_t i = 1; i <= members; ++i) {
    const bool intact = team.received(i).size() == 1 && team.received(i).back().packet.payload == payload;
    EXPECT_TRUE(intact) << i;
  }
  return counts;
}

TEST(Carriage, AFewNearMembersGetTheirOwnFramesAndManyOneForAll) {
  const auto [few_single, few_common] = group_frames(2, 6e6);
  EXPECT_GT(few_single, 10 * few_common);
  const auto [many_single, many_common] = group_frames(12, 6e6);
  EXPECT_GT(many_common, 5 * many_single);
  const auto [slow_single, slow_common] = group_frames(12, 1e6);
  EXPECT_GT(slow_single, 10 * slow_common);
}

TEST(LinkLayer, IsKnownByTheLossThatItHides) {
  routing::LinkLayer silent;
  for (int i = 0; i < 1000; ++i) silent.compare(0.0, 0.0);
  EXPECT_FALSE(silent.repeats().has_value()) << "no loss, no evidence";
  routing::LinkLayer repeating;
  for (int i = 0; i < 100; ++i) repeating.compare(0.2, 0.01);
  EXPECT_EQ(repeating.repeats(), true);
  for (int i = 0; i < 500; ++i) repeating.compare(0.2, 0.2);
  EXPECT_EQ(repeating.repeats(), false);
}

/// At the start a used link, whose loss the radio hides, was compared with the beacons of links that nobody used.
TEST(LinkLayer, TheTwoKindsOfLossAreNeverMixed) {
  routing::LinkLayer link_layer;
  EXPECT_EQ(link_layer.loss(0.3, 0.01), 0.3) << "it may repeat";
  EXPECT_EQ(link_layer.loss(0.1, 0.6), 0.6) << "beacons tell late of a link that fades";
  EXPECT_EQ(link_layer.loss(0.3, std::nullopt), 0.3);
  for (int i = 0; i < 100; ++i) link_layer.compare(0.2, 0.01);
  EXPECT_EQ(link_layer.loss(0.1, 0.6), 0.1);
  for (int i = 0; i < 500; ++i) link_layer.compare(0.2, 0.2);
  EXPECT_EQ(link_layer.loss(0.3, 0.01), 0.01);
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
