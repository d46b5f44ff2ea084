// The simulated radio where frames for one robot and frames for everybody differ.
#include <gtest/gtest.h>

#include "medium/medium.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFrameOctets = 1500;

Frame frame_of(std::size_t sender) { return {wire::kEverybody, Team::address(sender), Bytes(kFrameOctets)}; }

Frame frame_of(std::size_t sender, std::size_t receiver) {
  return {Team::address(receiver), Team::address(sender), Bytes(kFrameOctets)};
}

void add_line(Medium& medium, const std::vector<double>& places) {
  for (const double x : places) {
    const auto node = medium.add_node(Team::name(medium.node_count()), Team::address(medium.node_count()));
    medium.set_position(node, x, 0);
  }
}

/// When the frame arrives, or when the air is quiet again, and who has got it.
std::pair<Time, std::size_t> outcome(Medium& medium, const Frame& frame, Time now) {
  medium.transmit(*medium.find("robot_0"), frame, now);
  std::size_t arrivals = 0;
  Time end = now;
  while (const auto next = medium.next_delivery()) {
    end = *next;
    arrivals += medium.deliveries(end).size();
  }
  return {end - now, arrivals};
}

MediumOptions mixed() {
  MediumOptions options;
  options.rates.broadcast = 6e6;
  options.rates.unicast = ofdm_rates();
  return options;
}

/// Nobody waits for a slot, so that each duration is known.
MediumOptions repeating(int retries) {
  MediumOptions options = mixed();
  options.contention = true;
  options.slots = 1;
  options.rates.unicast_retries = retries;
  return options;
}

Time on_air(double bit_rate) { return 50us + Time(static_cast<Time::rep>(8e9 * kFrameOctets / bit_rate)); }

TEST(MediumRates, TheFastestThatTheMarginAllows) {
  const std::vector<Rate> rates = ofdm_rates();
  EXPECT_DOUBLE_EQ(unicast_bit_rate(rates, std::nullopt), 6e6);
  EXPECT_DOUBLE_EQ(unicast_bit_rate(rates, 0.5), 6e6);
  EXPECT_DOUBLE_EQ(unicast_bit_rate(rates, 8.0), 24e6);
  EXPECT_DOUBLE_EQ(unicast_bit_rate(rates, 60.0), 54e6);
}

TEST(MediumRates, BroadcastsGoAtTheBaseRateAndUnicastsByDistance) {
  Medium medium(mixed(), 1);
  add_line(medium, {0, 1, 6, 9.9, 12});  // range 10 m, exponent 4: 40, 8.9, 0.2 dB above the threshold, out of range
  using Outcome = std::pair<Time, std::size_t>;
  EXPECT_EQ(outcome(medium, frame_of(0), 1s), Outcome(on_air(6e6), 3));
  EXPECT_EQ(outcome(medium, frame_of(0, 1), 2s), Outcome(on_air(54e6), 1));
  EXPECT_EQ(outcome(medium, frame_of(0, 2), 3s), Outcome(on_air(24e6), 1));
  EXPECT_EQ(outcome(medium, frame_of(0, 3), 4s), Outcome(on_air(6e6), 1));
  EXPECT_EQ(outcome(medium, frame_of(0, 4), 5s), Outcome(on_air(6e6), 0));
  EXPECT_EQ(medium.counters().air_time, 3 * on_air(6e6) + on_air(54e6) + on_air(24e6));
}

TEST(MediumRates, AUnicastThatNobodyAnswersIsRepeatedAndABroadcastIsNot) {
  Medium medium(repeating(7), 1);
  add_line(medium, {0, 1});
  medium.set_up(1, false, 0s);
  EXPECT_EQ(outcome(medium, frame_of(0), 1s).first, on_air(6e6));
  EXPECT_EQ(medium.counters().frames, 1u);
  const Time least = 8 * (on_air(54e6) + 44us);
  const Time waited = outcome(medium, frame_of(0, 1), 2s).first - least;
  EXPECT_EQ(medium.counters().frames, 9u);
  EXPECT_EQ(medium.counters().repeated, 7u);
  EXPECT_EQ(medium.counters().air_time, on_air(6e6) + least);
  EXPECT_GT(waited, 0s);  // windows of 1, 2, 4, ... 128 slots
  EXPECT_LT(waited, 254 * 9us);
}

TEST(MediumRates, OnlyItsReceiverAnswersAUnicast) {
  MediumOptions options = repeating(7);
  options.loss = 0.99999;
  Medium medium(options, 1);
  add_line(medium, {0, 1});
  const auto bystander = medium.add_node("silent");  // its address is not known before it sends
  medium.set_position(bystander, 1, 1);
  medium.set_link_loss(0, bystander, 0.0);
  outcome(medium, frame_of(0, 1), 1s);
  EXPECT_EQ(medium.counters().repeated, 7u);
}

TEST(MediumRates, RetriesGetThroughWhatTheLossOfOneTryWouldStop) {
  MediumOptions options = repeating(7);
  options.loss = 0.3;
  Medium medium(options, 1);
  add_line(medium, {0, 1});
  std::size_t unicasts = 0;
  std::size_t broadcasts = 0;
  for (int i = 0; i < 2000; ++i) {
    unicasts += outcome(medium, frame_of(0, 1), i * 1s).second;
    broadcasts += outcome(medium, frame_of(0), i * 1s + 500ms).second;
  }
  EXPECT_GE(unicasts, 1998u);  // 0.3^8 of them are lost
  EXPECT_NEAR(static_cast<double>(broadcasts) / 2000, 0.7, 0.03);
  EXPECT_NEAR(static_cast<double>(medium.counters().frames - 4000) / 2000, 0.3 / 0.7, 0.04);
}

TEST(MediumRates, WhatIsBehindAFrameThatIsRepeatedWaits) {
  Medium medium(repeating(1), 1);
  add_line(medium, {0, 1, 2});
  medium.set_up(1, false, 0s);
  medium.transmit(0, frame_of(0, 1), 0s);
  medium.transmit(0, frame_of(0, 2), 0s);
  std::vector<std::pair<Medium::Node, Time>> arrivals;
  while (const auto next = medium.next_delivery()) {
    for (const auto& delivery : medium.deliveries(*next)) arrivals.emplace_back(delivery.node, *next);
  }
  ASSERT_EQ(arrivals.size(), 1u);
  EXPECT_EQ(arrivals[0].first, 2u);
  EXPECT_GE(arrivals[0].second, 3 * (on_air(54e6) + 44us));
}

TEST(MediumRates, ANodeThatGoesDownInTheMiddleOfItsRetriesStartsAfresh) {
  Medium medium(repeating(7), 1);
  add_line(medium, {0, 1});
  medium.set_up(1, false, 0s);
  medium.transmit(0, frame_of(0, 1), 0s);
  while (medium.counters().repeated < 3) medium.deliveries(*medium.next_delivery());
  const Time now = *medium.next_delivery();
  medium.set_up(0, false, now);
  medium.set_up(0, true, now);
  medium.set_up(1, true, now);
  EXPECT_EQ(outcome(medium, frame_of(0, 1), now + 10ms), (std::pair<Time, std::size_t>(on_air(54e6) + 44us, 1)));
}

}  // namespace
}  // namespace adhoc_communication
