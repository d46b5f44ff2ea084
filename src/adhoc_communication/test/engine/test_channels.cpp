// Channels that lose, delay and fade otherwise than by chance for each frame: the medium's, and what the engine makes
// of them.
#include <gtest/gtest.h>

#include "finish.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "transport/hop_sender.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

Frame channel_frame(Medium::Node sender, std::size_t octets = 1000) {
  Frame frame;
  frame.destination.fill(0xff);
  frame.source = Team::address(sender);
  frame.bytes.assign(octets, 0);
  return frame;
}

/// When the frames arrive that are sent at these times; nothing for one that is lost. They are of different lengths.
std::vector<std::optional<Time>> arrivals_of(const MediumOptions& options, std::uint64_t seed,
                                             const std::vector<Time>& sent) {
  Medium medium(options, seed);
  medium.add_node("a");
  medium.add_node("b");
  std::vector<std::optional<Time>> arrived(sent.size());
  const auto take = [&](Time until) {
    while (medium.next_delivery() && *medium.next_delivery() <= until) {
      const Time at = *medium.next_delivery();
      for (const auto& delivery : medium.deliveries(at)) arrived.at(delivery.frame->bytes.size() - 100) = at;
    }
  };
  for (std::size_t i = 0; i < sent.size(); ++i) {
    take(sent[i]);
    medium.transmit(0, channel_frame(0, 100 + i), sent[i]);
  }
  take(Time::max());
  return arrived;
}

std::vector<Time> every(Time interval, std::size_t count) {
  std::vector<Time> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<int>(i) * interval);
  return times;
}

TEST(MediumBursts, TakeTheirShareOfTimeInStretchesOfTheirLength) {
  Bursts bursts({300ms, 100ms, 1.0}, 7);
  int bad = 0;
  int begun = 0;
  bool before = false;
  constexpr int kSteps = 4'000'000;
  for (int i = 0; i < kSteps; ++i) {
    const bool now = bursts.bad(0, 1, i * 1ms);
    bad += now;
    begun += now && !before;
    before = now;
  }
  EXPECT_NEAR(static_cast<double>(bad) / kSteps, 0.25, 0.01);
  EXPECT_NEAR(static_cast<double>(bad) / begun, 100.0, 5.0);
}

TEST(MediumBursts, AreTheSameBothWaysAndWhateverIsAsked) {
  const BurstOptions options{30ms, 20ms, 1.0};
  Bursts often(options, 3);
  Bursts seldom(options, 3);
  Bursts other(options, 4);
  int differ = 0;
  for (Time at{0}; at < 200s; at += 5ms) {
    const bool bad = often.bad(0, 1, at);
    differ += other.bad(0, 1, at) != bad;
    if (at % 700ms == 0ms) EXPECT_EQ(seldom.bad(1, 0, at), bad) << at.count();
  }
  EXPECT_GT(differ, 1000);
}

TEST(MediumBursts, LoseFrames) {
  MediumOptions options;
  options.bursts = {300ms, 100ms, 1.0};
  const auto arrived = arrivals_of(options, 5, every(1ms, 1000));
  const auto lost = std::count(arrived.begin(), arrived.end(), std::nullopt);
  EXPECT_GT(lost, 50);
  EXPECT_LT(lost, 600);
  options.bursts.loss = 0.0;
  const auto all = arrivals_of(options, 5, every(1ms, 1000));
  EXPECT_EQ(std::count(all.begin(), all.end(), std::nullopt), 0);
}

TEST(MediumDelay, ComesOnTopOfTheAirTime) {
  MediumOptions options;
  const auto direct = arrivals_of(options, 1, every(1ms, 20));
  options.delay.fixed = 300ms;
  const auto delayed = arrivals_of(options, 1, every(1ms, 20));
  for (std::size_t i = 0; i < direct.size(); ++i) EXPECT_EQ(*delayed[i], *direct[i] + 300ms);
}

TEST(MediumDelay, JitterKeepsTheOrderUnlessAsked) {
  MediumOptions options;
  const auto direct = arrivals_of(options, 1, every(1ms, 200));
  options.delay.jitter = 50ms;
  const auto in_order = arrivals_of(options, 1, every(1ms, 200));
  options.delay.reorders = true;
  const auto reordered = arrivals_of(options, 1, every(1ms, 200));
  int overtaken = 0;
  for (std::size_t i = 0; i < direct.size(); ++i) {
    EXPECT_GE(*in_order[i], *direct[i]);
    EXPECT_LT(*in_order[i] - *direct[i], 50ms);
    EXPECT_LT(*reordered[i] - *direct[i], 50ms);
    if (i == 0) continue;
    EXPECT_GE(*in_order[i], *in_order[i - 1]);
    overtaken += *reordered[i] < *reordered[i - 1];
  }
  EXPECT_GT(overtaken, 50);
}

TEST(MediumDelay, WhoFallsSilentMeanwhileGetsNothing) {
  MediumOptions options;
  options.delay.fixed = 10ms;
  Medium medium(options, 1);
  medium.add_node("a");
  medium.add_node("b");
  medium.transmit(0, channel_frame(0), 0ms);
  EXPECT_TRUE(medium.deliveries(5ms).empty());
  medium.set_up(1, false, 5ms);
  medium.set_up(1, true, 6ms);
  EXPECT_TRUE(medium.deliveries(1s).empty());
}

TEST(MediumInterference, DestroysWhatIsOnTheAirMeanwhile) {
  MediumOptions options;
  options.interference = {20ms, 10ms};
  const auto arrived = arrivals_of(options, 1, {9'990us, 10ms, 15ms, 19'900us, 20ms, 35ms});
  EXPECT_FALSE(arrived[0]);
  EXPECT_TRUE(arrived[1]);
  EXPECT_TRUE(arrived[2]);
  EXPECT_TRUE(arrived[3]);  // 50 us and 103 octets at 50 Mbit/s are 66 us
  EXPECT_FALSE(arrived[4]);
  EXPECT_TRUE(arrived[5]);
  EXPECT_FALSE(arrivals_of(options, 1, {19'950us})[0]);  // not over when the interference begins
}

TEST(Medium, BitRateChangesFromTheNextFrameOn) {
  Medium medium(MediumOptions(), 1);
  medium.add_node("a");
  medium.add_node("b");
  medium.set_bit_rate(1e6);
  medium.transmit(0, channel_frame(0, 1000), 0ms);
  EXPECT_EQ(medium.next_delivery(), Time(8ms + 50us));
  EXPECT_THROW(medium.set_bit_rate(0.0), std::invalid_argument);
}

TEST(Medium, ChannelsThatCannotBeAreRefused) {
  const auto refused = [](auto change) {
    MediumOptions options;
    change(options);
    EXPECT_THROW(Medium(options, 1), std::invalid_argument);
  };
  refused([](MediumOptions& o) { o.bursts.bad = Time(-1); });
  refused([](MediumOptions& o) { o.bursts.loss = 1.5; });
  refused([](MediumOptions& o) { o.delay.fixed = Time(-1); });
  refused([](MediumOptions& o) { o.delay.jitter = Time(-1); });
  refused([](MediumOptions& o) { o.interference.duration = Time(-1); });
  refused([](MediumOptions& o) { o.interference = {10ms, 20ms}; });
}

/// The distances of frames that jitter stretched were taken for air time: 2 MB took 11 to 22 s.
TEST(Channels, JitterIsNoSlowRadio) {
  for (const bool reorders : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      MediumOptions medium;
      medium.delay = {0ms, 50ms, reorders};
      Team team(medium, seed);
      team.add_line(2);
      team.run_for(4s);
      const SendId id = team.send(0, Team::name(1), noise(2'000'000), Priority::kBulk);
      ASSERT_TRUE(finish(team, 0, id)) << seed;
      EXPECT_TRUE(team.finished(0, id)->delivered) << seed;
      EXPECT_LT(team.now(), 4s + 6s) << seed;
    }
  }
}

/// A search that ended after 1.8 s gave packets up for a robot that a fade hid for two.
TEST(Channels, AFadeOfAFewSecondsLosesNoPacket) {
  for (const std::size_t hops : {1, 3}) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      Team team({}, seed);
      team.add_line(hops + 1);
      team.run_for(4s + seed * 70ms);
      const SendId id = team.send(0, Team::name(hops), noise(1'000'000), Priority::kBulk);
      team.run_for(50ms);
      team.medium().set_link_loss(0, 1, 1.0);
      team.run_for(3s);
      ASSERT_EQ(team.finished(0, id), nullptr) << hops << " hops, seed " << seed;
      team.medium().set_link_loss(0, 1, std::nullopt);
      const Time end = team.now();
      ASSERT_TRUE(finish(team, 0, id));
      EXPECT_TRUE(team.finished(0, id)->delivered) << hops << " hops, seed " << seed;
      EXPECT_LT(team.finished_at(0, id) - end, 1500ms) << hops << " hops, seed " << seed;
    }
  }
}

/// Whoever is gone for good is given up once it counts as lost, and no later than a second after that.
TEST(Channels, WhoIsGoneIsGivenUpWhenItCountsAsLost) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Team team({}, seed);
    team.add_line(2);
    team.run_for(4s);
    team.kill(1);
    const SendId id = team.send(0, "robot_1", text("x"));
    ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 10s));
    EXPECT_FALSE(team.finished(0, id)->delivered);
    ASSERT_EQ(team.presence(0).back().second, "-robot_1");
    EXPECT_GE(team.finished_at(0, id), team.presence(0).back().first);
    EXPECT_LT(team.finished_at(0, id) - team.presence(0).back().first, 1s);
  }
}

/// 1 MB over links whose frames are delayed; frames repeated for 100 sent.
std::pair<double, double> delayed_transfer(Time delay, std::size_t hops, std::uint64_t seed = 1) {
  MediumOptions medium;
  medium.delay.fixed = delay;
  Team team(medium, seed);
  team.add_line(hops + 1);
  team.run_for(4s);
  const Time begin = team.now();
  const SendId id = team.send(0, Team::name(hops), noise(1'000'000), Priority::kBulk);
  team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 300s);
  EXPECT_TRUE(team.finished(0, id) != nullptr && team.finished(0, id)->delivered);
  const DataFrames frames = team.engine(0).statistics().unicast_data;
  const double time = std::chrono::duration<double>(team.finished_at(0, id) - begin).count();
  return {time, 100.0 * static_cast<double>(frames.sent_again) / static_cast<double>(frames.sent)};
}

/// A long way looked like a crowded channel, on which only 16 frames may be open: 0.42, 4.8 and 30 s over one hop.
TEST(Channels, DelayIsNotTakenForACrowd) {
  EXPECT_LT(delayed_transfer(5ms, 1).first, 0.40);
  EXPECT_LT(delayed_transfer(5ms, 3).first, 0.50);
  EXPECT_LT(delayed_transfer(50ms, 1).first, 2.4);
  EXPECT_LT(delayed_transfer(300ms, 1).first, 14.0);
}

/// The longest timers ran out before any answer could be there, and everything was sent twice.
TEST(Channels, TimersAreLongerThanTheWay) {
  for (const std::size_t hops : {1, 3}) EXPECT_LT(delayed_transfer(300ms, hops).second, 5.0) << hops;
}

/// Before an answer could be there, the packet was cut into segments of 512 or 256 octets, in one of five teams: 58 s.
TEST(Channels, ALongWayIsNotTakenForOneOfShortFrames) {
  for (const std::uint64_t seed : {407, 408, 709, 716}) EXPECT_LT(delayed_transfer(300ms, 3, seed).first, 15.0) << seed;
}

/// Nothing had told how long the way is beside the air, so that the radio was believed to hold what was on the way, and
/// waited for: 1.3 to 2 s, by what became a measurement.
TEST(Channels, WhatIsOnALongWayIsNotBelievedToBeInTheRadio) {
  for (const std::uint64_t seed : {1, 703, 715, 720}) {
    MediumOptions medium;
    medium.delay.fixed = 5ms;
    Team team(medium, seed);
    team.add_line(4);
    team.run_for(4s);
    SendId last = 0;
    for (int packet = 0; packet < 5; ++packet) last = team.send(0, "robot_3", noise(1'000'000), Priority::kBulk);
    EXPECT_TRUE(team.run_until_done([&] { return team.finished(0, last) != nullptr; }, 1250ms)) << seed;
  }
}

/// Until it was known for what it is, frames seemed to wait for those of others, and for ten seconds turns were taken:
/// 14.7 s.
TEST(Channels, JitterIsNoSharedChannel) {
  MediumOptions medium;
  medium.delay.jitter = 50ms;
  Team team(medium, 401);
  team.add_line(4);
  team.run_for(4s);
  SendId last = 0;
  for (std::uint64_t packet = 0; packet < 5; ++packet) {
    last = team.send(0, "robot_3", noise(1'000'000, 5 * 401 + packet), Priority::kBulk);
  }
  EXPECT_TRUE(team.run_until_done([&] { return team.finished(0, last) != nullptr; }, 10s));
}

/// The link was given up before the first answer could be there, and the answer told nothing any more.
TEST(HopSender, AnAnswerThatComesAfterTheLinkWasGivenUpTellsHowLongAnswersTake) {
  transport::HopSender sender(1, 10);
  sender.start({wire::FrameType::kData, text("x"), 0}, 1, 0ms);
  EXPECT_TRUE(sender.dead(160ms));
  sender.clear();
  wire::HopAcknowledgment acknowledgment;
  acknowledgment.newest_counter = 1;
  acknowledgment.highest = 1;
  acknowledgment.received = 1;
  sender.acknowledged(acknowledgment, 600ms);
  sender.start({wire::FrameType::kData, text("x"), 0}, 2, 700ms);
  sender.expire(1290ms);
  EXPECT_FALSE(sender.dead(1290ms));
}

}  // namespace
}  // namespace adhoc_communication
