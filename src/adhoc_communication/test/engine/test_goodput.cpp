// No air is wasted: what is repeated, how often acknowledgments go out, how the air is estimated.
#include <gtest/gtest.h>

#include <initializer_list>
#include <set>

#include "air/air_clock.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "transport/hop_receiver.hpp"
#include "transport/hop_sender.hpp"
#include "transport/stream_sender.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using air::AirClock;
using transport::AcknowledgmentDelays;
using transport::HopReceiver;
using transport::HopSender;
using transport::StreamSender;

constexpr std::uint32_t kSegments = 600;

/// A packet of kSegments segments of 10 octets, and what its receiver acknowledges.
struct Stream {
  StreamSender sender{0, 1, StreamSender::kWindow};
  std::set<std::uint32_t> received;
  Random random{1};

  Stream() { sender.add(1, std::make_shared<Bytes>(10 * kSegments), 10, 0ms); }

  std::uint32_t send(Time now) { return sender.next_segment(now).index; }
  void send_many(std::uint32_t count, Time from, Time spacing) {
    for (std::uint32_t i = 0; i < count; ++i) send(from + i * spacing);
  }
  void receive(std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t index = begin; index < end; ++index) received.insert(index);
  }
  void acknowledge(Time now) {
    wire::PartialPacket partial{1, 0, 0, {}};
    while (received.count(partial.first_missing) != 0) ++partial.first_missing;
    partial.received.assign(kSegments / 8, 0);
    for (const std::uint32_t index : received) {
      if (index <= partial.first_missing) continue;
      const std::uint32_t bit = index - partial.first_missing - 1;
      partial.received[bit / 8] |= static_cast<std::uint8_t>(1 << bit % 8);
    }
    wire::TransportAcknowledgment acknowledgment;
    acknowledgment.source_boot = 1;
    acknowledgment.next = 1;
    acknowledgment.partial = {partial};
    sender.acknowledged(acknowledgment, now);
  }
  /// Segments sent before that the sender would send again at once.
  int repeats(std::uint32_t started, Time now) {
    int count = 0;
    while (sender.has_segment() && send(now) < started) ++count;
    return count;
  }
};

/// 300 segments, one each millisecond, of which the first is believed to be lost and repeated at 300 ms.
Stream with_one_repeated() {
  Stream stream;
  stream.send_many(300, 0ms, 1ms);
  stream.receive(1, 100);
  stream.acknowledge(300ms);
  EXPECT_EQ(stream.send(300ms), 0u);
  return stream;
}

TEST(StreamSender, AFirstCopyThatComesLateDoesNotMakeTheOthersLookLost) {
  Stream stream = with_one_repeated();
  stream.receive(0, 1);
  stream.acknowledge(310ms);
  EXPECT_EQ(stream.repeats(300, 310ms), 0);
}

TEST(StreamSender, ANeedlessRepetitionTeachesThatTheWayReordersMore) {
  Stream stream = with_one_repeated();
  stream.receive(0, 1);
  stream.acknowledge(310ms);
  stream.receive(101, 161);  // number 100 is 60 ms behind
  stream.acknowledge(340ms);
  EXPECT_EQ(stream.repeats(300, 340ms), 0);
  stream.receive(161, 190);
  stream.acknowledge(350ms);
  EXPECT_EQ(stream.repeats(300, 350ms), 1);
}

TEST(StreamSender, TheRepetitionShowsThatAllBeforeItIsLost) {
  Stream stream = with_one_repeated();
  stream.receive(0, 1);
  stream.acknowledge(600ms);  // as late as the second copy would come
  EXPECT_EQ(stream.repeats(300, 600ms), 149) << "of 200, those sent more than a quarter of 204 ms before it";
}

TEST(StreamSender, WhatIsFollowedBySilenceWasTheRepetition) {
  Stream stream = with_one_repeated();
  stream.receive(0, 1);
  stream.acknowledge(310ms);
  const Time silent_until = stream.sender.next_deadline();
  stream.sender.expire(10, silent_until, stream.random);
  EXPECT_GE(stream.repeats(300, silent_until), 125);
}

/// Each put off the timer of the stream, so the send had no end.
TEST(StreamSender, RoutesThatNothingGetsThroughEndTheSend) {
  Stream stream;
  std::vector<StreamSender::GivenUp> given_up;
  for (Time now = 0ms; now < 60s && given_up.empty(); now += 100ms) {
    stream.sender.route_changed(now);
    given_up = stream.sender.expire(10, now, stream.random);
    if (stream.sender.has_segment()) stream.send(now);
  }
  ASSERT_EQ(given_up.size(), 1u);
  EXPECT_EQ(given_up.front().elapsed, transport::Silence::kNoProgress);
}

TEST(StreamSender, WhoHasAskedLittleIsNotDisappointed) {
  Stream stream;
  stream.send(0s);
  stream.sender.route_missing(40s);
  stream.sender.route_changed(41s);
  EXPECT_TRUE(stream.sender.expire(10, 41s, stream.random).empty());
}

TEST(HopReceiver, AcknowledgesWhenFramesStopOrAreMany) {
  HopReceiver receiver(1);
  std::uint32_t sequence = 0;
  const auto due_after = [&](std::initializer_list<Time> arrivals) {
    for (const Time at : arrivals) {
      ++sequence;
      receiver.take(sequence, sequence, false, at);
    }
    return receiver.due();
  };
  EXPECT_EQ(due_after({0ms, 1ms, 2ms}), 5ms) << "3 ms after the latest";
  EXPECT_EQ(due_after({4ms, 6ms}), 9ms);
  EXPECT_EQ(due_after({7ms, 8ms}), 10ms) << "10 ms after the first";
  EXPECT_EQ(due_after({9ms}), 9ms) << "the eighth";
  receiver.acknowledge(9ms);
  EXPECT_EQ(due_after({100ms, 101ms, 102ms, 104500us, 107200us}), 110ms) << "10 ms after the first";
}

/// At 12 Mbit/s every third frame was acknowledged on a route of two hops, and on Wi-Fi each of these destroyed frames
/// of the robot before the relay, which does not hear them.
TEST(HopReceiver, AcknowledgesNoMoreOftenWhereFramesComeSlowly) {
  HopReceiver receiver(1);
  receiver.delay(AcknowledgmentDelays::of(1340us));
  for (std::uint32_t sequence = 1; sequence < 8; ++sequence) {
    const Time arrival = sequence * 3300us;
    EXPECT_GT(receiver.due(), arrival) << sequence;
    receiver.take(sequence, sequence, false, arrival);
  }
  receiver.take(8, 8, false, 8 * 3300us);
  EXPECT_EQ(receiver.due(), 8 * 3300us) << "the eighth";
}

TEST(HopReceiver, HoldsAcknowledgmentsBackByTheUsualTimeOnAFastRadio) {
  for (const Time frame : {Time(0), Time(300us)}) {
    const AcknowledgmentDelays delays = AcknowledgmentDelays::of(frame);
    EXPECT_EQ(delays.quiet, AcknowledgmentDelays::kQuiet);
    EXPECT_EQ(delays.longest, AcknowledgmentDelays::kLongest);
  }
  EXPECT_LE(AcknowledgmentDelays::of(15ms).longest, 60ms) << "on the slowest one";
}

TEST(HopReceiver, TellsAGapSoonButSeveralTogether) {
  HopReceiver receiver(1);
  receiver.take(1, 1, false, 0us);
  receiver.take(3, 3, false, 300us);
  EXPECT_EQ(receiver.due(), 1300us);
  receiver.take(5, 5, false, 600us);
  EXPECT_EQ(receiver.due(), 1300us);
  receiver.take(6, 6, false, 900us);
  EXPECT_EQ(receiver.due(), 900us);
}

TEST(HopReceiver, TellsOfFramesThatArriveTogetherOrTheOtherWayRound) {
  HopReceiver receiver(1);
  receiver.take(1, 1, false, 0us);
  receiver.take(2, 2, false, 300us);
  EXPECT_EQ(receiver.acknowledge(300us).spacing_ns, 300'000u);
  receiver.take(3, 3, false, 300us);
  EXPECT_EQ(receiver.acknowledge(300us).spacing_ns, 1u);
  receiver.take(5, 5, false, 600us);
  EXPECT_EQ(receiver.acknowledge(600us).spacing_ns, 0u) << "unknown";
  receiver.take(4, 4, false, 700us);
  EXPECT_EQ(receiver.acknowledge(700us).spacing_ns, 1u);
}

TEST(HopReceiver, SingleFramesAreAcknowledgedSoon) {
  HopReceiver receiver(1);
  receiver.take(1, 1, false, 0ms);
  receiver.take(2, 2, false, 2ms);
  EXPECT_EQ(receiver.due(), 3ms) << "two frames are no stream";
  receiver.acknowledge(3ms);
  receiver.take(4, 4, false, 10ms);
  EXPECT_EQ(receiver.due(), 10ms) << "a gap";
}

TEST(HopSender, TheTimerWaitsForAnAcknowledgmentHeldBackByFurtherFrames) {
  HopSender sender(1, 10);
  std::uint64_t counter = 0;
  const auto send = [&](Time now) { sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now); };
  send(0ms);
  const Time alone = sender.next_deadline();
  for (Time now = 1ms; now <= 30ms; now += 2ms) {
    sender.heard(now);
    sender.expire(now);
    if (sender.unresolved() < HopSender::kMostUnresolved) send(now);
    if (now < alone + AcknowledgmentDelays::kLongest) EXPECT_FALSE(sender.has_resend(0)) << now / 1us;
  }
  sender.expire(alone + AcknowledgmentDelays::kLongest);
  EXPECT_TRUE(sender.has_resend(0)) << "not put off without end";
}

TEST(HopSender, OnlyQuickAnswersOpenTheWholeWindow) {
  for (const Time answer : {2ms, 40ms}) {
    HopSender sender(1, 10);
    std::uint64_t counter = 0;
    const auto fill = [&](Time now) {
      while (sender.may_start()) sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now);
      return sender.unresolved();
    };
    EXPECT_EQ(fill(0ms), HopSender::kFewUnresolved) << "nothing is known";
    const auto highest = static_cast<std::uint32_t>(counter);
    sender.acknowledged({0, counter, 0, 0, highest, ~std::uint64_t{0}}, answer);
    EXPECT_EQ(fill(answer), answer < 10ms ? HopSender::kMostUnresolved : HopSender::kFewUnresolved);
  }
}

/// All frames were handed to a radio that repeats each for 20 ms, and the search for another way waited behind them.
TEST(HopSender, ASilentNeighborGetsFewFramesWhereTheRadioMayRepeatThem) {
  HopSender sender(1, 10);
  sender.be_sparing(true);
  std::uint64_t counter = 0;
  const auto fill = [&](Time now) {
    while (sender.has_resend(0) && sender.may_resend()) sender.resend(0, {}, ++counter, now);
    while (sender.may_start()) sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now);
    return sender.unresolved();
  };
  sender.heard(0ms);
  EXPECT_EQ(fill(0ms), HopSender::kFewUnresolved);
  sender.expire(20ms);
  EXPECT_EQ(fill(20ms), HopSender::kFewProbes) << "nothing was heard since they were sent";
  sender.expire(30ms);
  EXPECT_EQ(fill(30ms), HopSender::kFewProbes);
  sender.heard(31ms);
  EXPECT_EQ(fill(31ms), HopSender::kFewUnresolved) << "it lives";
  sender.be_sparing(false);
  sender.expire(200ms);
  EXPECT_EQ(fill(200ms), HopSender::kFewUnresolved) << "a radio that does not repeat is done with them soon";
}

/// Where none is lost, a neighbour from which nothing comes for longer than it may hold its answers back gets no
/// further frames; where frames are lost that is nothing unusual before a timer runs out.
TEST(HopSender, ACleanLinkThatFallsSilentIsProbedBeforeATimerRunsOut) {
  for (const bool clean : {true, false}) {
    HopSender sender(1, 10);
    sender.be_sparing(true);
    std::uint64_t counter = 0;
    const auto start = [&](int frames, Time now) {
      for (int i = 0; i < frames && sender.may_start(); ++i) {
        sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now);
      }
    };
    start(16, 0ms);
    const std::uint64_t received = clean ? ~std::uint64_t{0} : 0x5555'5555'5555'5555;
    sender.acknowledged({0, counter, 0, 0, static_cast<std::uint32_t>(counter), received}, 20ms);
    sender.heard(20ms);
    start(4, 21ms);
    sender.expire(55ms);
    EXPECT_EQ(sender.may_start(), !clean);
  }
}

/// Until the timers of 10 ms and more nothing moved when the answer to the frame that filled the window was lost.
TEST(HopSender, AFullWindowAsksAgainAsSoonAsTheAnswerIsOverdue) {
  HopSender sender(1, 10);
  std::uint64_t counter = 0;
  const auto start = [&](Time now) { sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now); };
  const auto all_arrived = [&] {
    return wire::HopAcknowledgment{0, counter, 0, 0, static_cast<std::uint32_t>(counter), ~std::uint64_t{0}};
  };
  Time now = 0ms;
  for (int i = 0; i < 30; ++i, now += 5ms) {
    start(now);
    sender.ask(counter, now);
    sender.acknowledged(all_arrived(), now + 1ms);
  }
  const std::uint64_t oldest = counter + 1;
  while (sender.may_start()) start(now);
  EXPECT_TRUE(sender.pressing());
  sender.ask(counter, now);
  EXPECT_EQ(sender.next_deadline(), now + HopSender::kShortestWait);
  sender.expire(now + 1ms);
  EXPECT_FALSE(sender.has_resend(0)) << "the answer may still come";
  sender.expire(now + HopSender::kShortestWait);
  ASSERT_TRUE(sender.has_resend(0));
  EXPECT_EQ(sender.resend(0, {}, ++counter, now + 2ms).link_sequence, oldest);
  EXPECT_TRUE(sender.pressing()) << "the repetition asks, too";
  EXPECT_FALSE(sender.has_resend(0)) << "one at a time";
}

/// A sender of single frames that knows that answers take 1 ms.
class EagerSender : public testing::Test {
 protected:
  EagerSender() {
    sender.be_eager(true);
    for (int i = 0; i < 30; ++i, now += 5ms) {
      start();
      sender.acknowledged({0, counter, 0, 0, static_cast<std::uint32_t>(counter), ~std::uint64_t{0}}, now + 1ms);
    }
    sender.heard(now);
  }
  void start(bool asks = true) {
    sender.start({wire::FrameType::kRouteReply, text("x"), 0}, ++counter, now);
    if (asks) sender.ask(counter, now);
  }
  /// Until the next repetition, which asks.
  Time wait() {
    const Time begin = now;
    now = sender.next_deadline();
    sender.expire(now);
    if (!sender.has_resend(0)) return Time::max();
    sender.resend(0, {}, ++counter, now);
    sender.ask(counter, now);
    return now - begin;
  }

  HopSender sender{1, 10};
  std::uint64_t counter = 0;
  Time now{0};
};

/// What goes over many hops waited for a timer of 10 ms and more at each that lost it.
TEST_F(EagerSender, AsksAgainAsSoonAsTheAnswerToASingleFrameIsOverdue) {
  start();
  EXPECT_FALSE(sender.pressing());
  EXPECT_EQ(wait(), HopSender::kShortestWait);
  EXPECT_TRUE(sender.pressing()) << "what follows asks, too";
  EXPECT_EQ(wait(), 2 * HopSender::kShortestWait);
  EXPECT_EQ(wait(), 4 * HopSender::kShortestWait);
  EXPECT_GE(wait(), HopSender::kShortestTimer) << "from then on the timer decides";
}

TEST_F(EagerSender, CountsOnTheQuietOfTheReceiver) {
  start(false);
  EXPECT_EQ(wait(), AcknowledgmentDelays::kQuiet + HopSender::kShortestWait);
}

/// Up to four questions stood in one window, each of which was answered.
TEST(HopSender, WhereTheRadioRepeatsOneQuestionIsEnoughUntilTheWindowIsFull) {
  for (const bool repeats : {true, false}) {
    HopSender sender(1, 10);
    sender.be_sparing(repeats);
    int questions = 0;
    for (std::uint64_t counter = 1; sender.may_start(); ++counter) {
      sender.start({wire::FrameType::kData, text("x"), 0}, counter, 0ms);
      if (!sender.pressing()) continue;
      sender.ask(counter, 0ms);
      ++questions;
    }
    EXPECT_TRUE(sender.pressing()) << "nothing more fits";
    if (repeats) EXPECT_EQ(questions, 2);
    if (!repeats) EXPECT_GT(questions, 3);
  }
}

/// Four of five links that ended on a crowded channel were good ones: 150 ms without a word were chance.
TEST(HopSender, ALinkThatLosesMuchDoesNotEndByAShortSilence) {
  HopSender sender(1, 100);
  std::uint64_t counter = 0;
  Time now = 0ms;
  const auto transmit = [&] {
    if (sender.has_resend(0)) {
      sender.resend(0, {}, ++counter, now);
    } else if (sender.idle()) {
      sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now);
    }
  };
  std::uint32_t answered = 0;
  for (int round = 1; round <= 40; ++round) {
    transmit();
    if (round % 4 != 0) {
      sender.expire(now += 600ms);
      continue;
    }
    sender.heard(now += 5ms);
    sender.acknowledged({{}, counter, 0, 0, ++answered, 1}, now);
    ASSERT_TRUE(sender.idle());
  }
  const Time begin = now;
  while (!sender.dead(now)) {
    transmit();
    sender.expire(now += 5ms);
  }
  EXPECT_GT(now - begin, 2 * HopSender::kSilence);
  EXPECT_LE(now - begin, HopSender::kNoProgress + 10ms) << "or what is gone would be held on to";
}

/// On Wi-Fi, whose radio repeats each for 20 ms, a frame every 4 ms for a neighbour that was gone stood before the
/// request for another way: it left the radio after the search had ended.
TEST(HopSender, AFullWindowThatNobodyAnswersIsRepeatedMoreAndMoreSeldom) {
  HopSender sender(1, 100);
  sender.be_sparing(true);
  std::uint64_t counter = 0;
  Time now = 0ms;
  const auto ask = [&] {
    if (sender.pressing()) sender.ask(counter, now);
  };
  // Answers that are asked for come after 4 ms, others are held back.
  for (; counter < 60; now += 1ms) {
    const bool asked = counter < 20;
    sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now);
    if (asked) sender.ask(counter, now);
    now += asked ? 4ms : 100ms;
    sender.heard(now);
    sender.acknowledged({{}, counter, 0, 0, static_cast<std::uint32_t>(counter), ~std::uint64_t{0}}, now);
  }
  while (sender.may_start()) {
    sender.start({wire::FrameType::kData, text("x"), 0}, ++counter, now);
    ask();
  }
  const std::uint64_t filled = counter;
  for (const Time end = now + 100ms; now < end; now += 500us) {
    sender.expire(now);
    while (sender.has_resend(0) && sender.may_resend()) {
      sender.resend(0, {}, ++counter, now);
      ask();
    }
  }
  EXPECT_LT(counter - filled, 16) << "a window's frames once at most, not one each 4 ms";
  EXPECT_GE(counter - filled, 4) << "of a lossy link, a few are repeated soon";
}

TEST_F(EagerSender, LeavesASharedChannelAlone) {
  sender.be_eager(false);
  start();
  EXPECT_EQ(wait(), HopSender::kShortestTimer);
  EXPECT_FALSE(sender.pressing());
}

/// All ten repetitions would be over sooner, and the link would seem to have nothing outstanding.
TEST_F(EagerSender, StillFindsALinkDead) {
  const Time begin = now;
  start();
  while (!sender.dead(now)) wait();
  EXPECT_EQ(sender.given_up(), 0u);
  EXPECT_EQ(now - begin, HopSender::kSilence);
}

TEST_F(EagerSender, LearnsFromLateAnswersThatTheyTakeLonger) {
  for (int i = 0; i < 30; ++i, now += 50ms) {
    start();
    const std::uint64_t first = counter;
    const Time sent = now;
    wait();
    sender.acknowledged({0, first, 0, 0, static_cast<std::uint32_t>(counter), ~std::uint64_t{0}}, sent + 4ms);
    const auto newest = static_cast<std::uint32_t>(counter);
    sender.acknowledged({0, counter, 0, 0, newest, ~std::uint64_t{0}}, now + 4ms);
  }
  start();
  EXPECT_GE(wait(), 4ms);
}

/// It may be the frame or the answer that was lost.
TEST_F(EagerSender, AMissingAnswerIsHalfALoss) {
  start();
  wait();
  sender.acknowledged({0, counter, 0, 0, 31, ~std::uint64_t{0}}, now + 1ms);
  EXPECT_NEAR(*sender.loss(now), 0.5 / 32, 0.002);
}

/// The first message in a team that hardly knows itself: three of four arrive within that time. The slowest of few is a
/// matter of chance: one in thirty takes longer than 150 ms.
TEST(Goodput, TheFirstMessageOverManyLossyHopsIsNotKeptWaiting) {
  MediumOptions medium;
  medium.loss = 0.3;
  std::vector<Time> taken;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Team team(medium, seed);
    team.add_line(11);
    team.run_for(1s);
    const Time begin = team.now();
    team.send(0, Team::name(10), text("x"));
    ASSERT_TRUE(team.run_until_done([&] { return !team.received(10).empty(); }, 10s));
    taken.push_back(team.now() - begin);
  }
  std::sort(taken.begin(), taken.end());
  EXPECT_LE(taken[14], 100ms);
}

/// On a shared channel: learned while another robot was sending, too, and then that one falls silent.
TEST(AirClock, FramesThatArriveSoonerThanBelievedCorrectTheEstimate) {
  AirClock clock(1500);
  const MacAddress peer{{2}};
  std::uint64_t counter = 0;
  const auto send = [&](Time now, Time first, Time second) {
    clock.transmitted(++counter, 1500, peer, now);
    clock.transmitted(++counter, 1500, peer, now);
    clock.acknowledged(counter, second, now + first + second, 0);
  };
  Time now = 0ms;
  for (int i = 0; i < 20; ++i, now += 10ms) send(now, 600us, 600us);
  const double shared = clock.rate(peer).nanoseconds_per_octet();
  EXPECT_NEAR(shared, 600'000.0 / 1800, 10);
  for (int i = 0; i < 20; ++i, now += 10ms) {
    clock.transmitted(++counter, 1500, peer, now);
    clock.acknowledged(counter, 0ms, now + 300us, 0);
  }
  EXPECT_NEAR(clock.rate(peer).nanoseconds_per_octet(), shared / 2, shared / 10);
}

/// The answer to the first of two frames waits for the second one, which the radio has already, or goes before it.
TEST(AirClock, AFrameThatAnAnswerHadToWaitForIsNotCountedTwice) {
  const MacAddress peer{{2}};
  for (const Time waited : {0us, 300us}) {
    AirClock clock(1500);
    std::uint64_t counter = 0;
    for (int i = 0; i < 20; ++i) {
      for (int frame = 0; frame < 2; ++frame) clock.transmitted(++counter, 1500, peer, i * 10ms);
      clock.acknowledged(counter, 300us, i * 10ms + 600us, 0);
    }
    const Time now = 1s;
    clock.transmitted(++counter, 1500, peer, now);
    clock.transmitted(++counter, 1500, peer, now + 150us);
    const Time answer = 63us;
    clock.acknowledged(counter - 1, 0us, now + 300us + waited + answer, transport::kAcknowledgmentOctets);
    EXPECT_NEAR(static_cast<double>((clock.idle_at() - now) / 1us), 600, 10) << waited / 1us;
  }
}

/// Data frames that the source of a transfer puts on the air for the first time, for each segment.
double starts_per_segment(std::size_t hops, const MediumOptions& medium, std::size_t octets) {
  Team team(medium, 3);
  team.add_line(hops + 1);
  team.run_for(1s);
  std::set<std::uint32_t> started;
  std::size_t longest = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    wire::Reader reader(frame.bytes);
    const auto header = wire::read_header(reader);
    if (robot != 0 || header->type != wire::FrameType::kData) return;
    started.insert(header->link_sequence);
    longest = std::max(longest, frame.bytes.size());
  };
  const SendId id = team.send(0, Team::name(hops), noise(octets), Priority::kBulk);
  EXPECT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 120s));
  const double segment = static_cast<double>(longest - wire::kHeaderSize - wire::kDataHeaderSize - wire::kTagSize);
  return static_cast<double>(started.size()) * segment / static_cast<double>(octets);
}

/// Nobody waits for what has been over for long.
TEST(Goodput, OneSharedHopIsHardlyEverIdle) {
  MediumOptions medium;
  medium.shared = true;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Team team(medium, seed);
    team.add_line(2);
    team.run_for(1s);
    const Time begin = team.now();
    const Time before = team.medium().counters().air_time;
    const SendId id = team.send(0, Team::name(1), noise(5'000'000), Priority::kBulk);
    ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s));
    const auto busy = static_cast<double>((team.medium().counters().air_time - before).count());
    EXPECT_GE(busy / static_cast<double>((team.now() - begin).count()), 0.975) << seed;
  }
}

TEST(Goodput, LossOnHopsDoesNotCauseRepetitionsEndToEnd) {
  MediumOptions medium;
  medium.loss = 0.3;
  EXPECT_LT(starts_per_segment(10, medium, 5'000'000), 1.02);
  medium.shared = true;
  EXPECT_LT(starts_per_segment(3, medium, 5'000'000), 1.02);
}

/// Every 64 frames it ran dry, since the next two were to measure how long it takes for one.
TEST(Goodput, ARadioThatRepeatsFramesByItselfIsKeptBusy) {
  MediumOptions medium;
  medium.contention = true;
  medium.loss = 0.2;
  medium.rates.unicast_retries = 7;
  Team team(medium, 3);
  team.add_line(2);
  team.run_for(1s);
  for (int packet = 0; packet < 20; ++packet) team.send(0, "robot_1", noise(1'000'000, packet), Priority::kBulk);
  team.run_for(2s);
  int idle = 0;
  for (int i = 0; i < 10000; ++i) {
    team.run_for(100us);
    idle += !team.medium().keeps_frames(0);
  }
  EXPECT_LT(idle, 300) << "of 10000 moments";
}

}  // namespace
}  // namespace adhoc_communication
