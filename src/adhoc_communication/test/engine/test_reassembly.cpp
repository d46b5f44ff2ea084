// Who gets room for packets that are put together, and what becomes of those that do not.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "transport/reassembly.hpp"
#include "transport/stream_receiver.hpp"
#include "transport/stream_sender.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using transport::Reassembly;

constexpr std::size_t kLargestWhole = 100'000;
constexpr std::size_t kLittleWhole = kLargestWhole / Reassembly::kLittlePackets;

Reassembly::Key key(std::uint8_t source, std::uint32_t packet, std::uint8_t carrier = 2) {
  return {{2, 0, 0, 0, 0, source}, 1, carrier, packet};
}

std::vector<std::uint32_t> evicted(Reassembly& reassembly) {
  std::vector<std::uint32_t> packets;
  for (const Reassembly::Key& key : reassembly.take_evicted()) packets.push_back(key.packet);
  return packets;
}

TEST(Reassembly, WhatWasAdmittedIsFinishedBeforeOthersBegin) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source)
    EXPECT_TRUE(reassembly.admit(key(source, 1), kLargestWhole, true, 0s));
  for (Time now = 0s; now < 5s; now += 100ms) {
    for (std::uint8_t source = 1; source <= 4; ++source) reassembly.progress(key(source, 1), 1400, now);
    EXPECT_FALSE(reassembly.admit(key(5, 1), kLargestWhole, true, now));
  }
  reassembly.release(key(2, 1));
  EXPECT_TRUE(reassembly.admit(key(5, 1), kLargestWhole, true, 5s));
  EXPECT_TRUE(evicted(reassembly).empty());
}

TEST(Reassembly, ASourceTakesHalfAtMost) {
  Reassembly reassembly(kLargestWhole);
  EXPECT_TRUE(reassembly.admit(key(1, 1), kLargestWhole, true, 0s));
  EXPECT_TRUE(reassembly.admit(key(1, 1, Reassembly::kGroup), kLargestWhole, true, 0s));
  EXPECT_FALSE(reassembly.admit(key(1, 1, Reassembly::kBroadcast), kLargestWhole, true, 0s));
  EXPECT_TRUE(reassembly.admit(key(2, 1), kLargestWhole, true, 0s));
  reassembly.keep(key(1, 1, Reassembly::kGroup), 0s);
  EXPECT_FALSE(reassembly.admit(key(1, 2, Reassembly::kGroup), kLargestWhole, false, 0s)) << "complete, but needed";
  reassembly.spare(key(1, 1, Reassembly::kGroup));
  EXPECT_TRUE(reassembly.admit(key(1, 2, Reassembly::kGroup), kLargestWhole, false, 0s)) << "nobody needs it";
  EXPECT_TRUE(evicted(reassembly).empty());
}

/// Later packets of a stream that had taken all the room waited for the first one, and that one for room.
TEST(Reassembly, LaterPacketsMakeRoomForTheOneTheyWaitFor) {
  Reassembly reassembly(kLargestWhole);
  EXPECT_TRUE(reassembly.admit(key(1, 2), kLargestWhole, false, 0s));
  EXPECT_TRUE(reassembly.admit(key(1, 3), kLargestWhole, false, 0s));
  EXPECT_FALSE(reassembly.admit(key(1, 4), kLargestWhole, false, 0s));
  EXPECT_TRUE(reassembly.admit(key(1, 1), kLargestWhole, true, 0s));
  EXPECT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{3}));
}

TEST(Reassembly, TheYoungestOfTheStalledMakesRoom) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source) reassembly.admit(key(source, source), kLargestWhole, true, 0s);
  reassembly.progress(key(4, 4), 50'000, 1s);
  EXPECT_TRUE(reassembly.admit(key(5, 5), kLargestWhole, true, 2s));
  EXPECT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{3}));
  EXPECT_FALSE(reassembly.stalled(key(4, 4), 2s));
}

TEST(Reassembly, ATrickleDoesNotHoldRoom) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source) reassembly.admit(key(source, source), kLargestWhole, true, 0s);
  for (Time now = 0s; now <= 10s; now += 500ms) {
    for (std::uint8_t source = 1; source <= 4; ++source) reassembly.progress(key(source, source), 64, now);
  }
  EXPECT_TRUE(reassembly.admit(key(5, 5), kLargestWhole, true, 10s));
}

/// Packets of two sources that were never given room by others, as long as they brought more than 8 kB/s each.
TEST(Reassembly, LittlePacketsHaveAShareForThemselves) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source) reassembly.admit(key(source, 1), kLargestWhole, true, 0s);
  for (Time now = 0s; now < 5s; now += 100ms) {
    for (std::uint8_t source = 1; source <= 4; ++source) reassembly.progress(key(source, 1), 1400, now);
    EXPECT_TRUE(reassembly.admit(key(5, 1), kLittleWhole, true, now));
    reassembly.release(key(5, 1));
  }
  EXPECT_FALSE(reassembly.admit(key(5, 1), kLittleWhole + 1, true, 5s));
  EXPECT_TRUE(evicted(reassembly).empty());
}

TEST(Reassembly, WhoHoldsMostGivesUpItsYoungestForWhoHoldsLess) {
  Reassembly reassembly(kLargestWhole);
  for (const std::uint32_t packet : {1, 2}) {
    for (const std::uint8_t source : {1, 2}) reassembly.admit(key(source, packet), kLargestWhole, true, 0s);
  }
  EXPECT_TRUE(reassembly.admit(key(3, 7), kLargestWhole, true, 100ms));
  ASSERT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{2}));
  EXPECT_FALSE(reassembly.admit(key(3, 8), kLargestWhole, false, 100ms)) << "it would hold more than the other";
  EXPECT_TRUE(reassembly.admit(key(4, 9), kLargestWhole, true, 100ms));
  ASSERT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{2}));
  for (std::uint8_t source = 1; source <= 5; ++source) {
    EXPECT_FALSE(reassembly.admit(key(source, 10), kLargestWhole, false, 100ms)) << "each has one";
  }
}

TEST(Reassembly, LittlePacketsOfOneSourceDoNotFillTheirShare) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source) reassembly.admit(key(source, 1), kLargestWhole, true, 0s);
  for (const std::uint8_t source : {5, 6}) {
    for (std::uint32_t packet = 1; packet <= Reassembly::kLittlePackets / 2; ++packet) {
      EXPECT_TRUE(reassembly.admit(key(source, packet), kLittleWhole, true, 0s));
    }
    EXPECT_FALSE(reassembly.admit(key(source, 100), kLittleWhole, false, 0s));
  }
  EXPECT_TRUE(reassembly.admit(key(7, 1), 1000, true, 0s));
  EXPECT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{Reassembly::kLittlePackets / 2}));
  EXPECT_LE(reassembly.little().taken(), reassembly.little().most());
}

TEST(Reassembly, SparePacketsMakeRoomFirst) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source) {
    reassembly.admit(key(source, source, Reassembly::kGroup), kLargestWhole, true, 0s);
    reassembly.keep(key(source, source, Reassembly::kGroup), 0s);
  }
  EXPECT_FALSE(reassembly.admit(key(5, 5), kLargestWhole, true, 1s));
  for (const std::uint8_t source : {2, 4}) reassembly.spare(key(source, source, Reassembly::kGroup));
  EXPECT_TRUE(reassembly.admit(key(5, 5), kLargestWhole, true, 1s));
  EXPECT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{2})) << "the oldest of them";
}

/// They held it for ever.
TEST(Reassembly, CompletePacketsOfWhichNothingIsPassedOnMakeRoom) {
  Reassembly reassembly(kLargestWhole);
  for (std::uint8_t source = 1; source <= 4; ++source) {
    reassembly.admit(key(source, source, Reassembly::kGroup), kLargestWhole, true, 0s);
    reassembly.keep(key(source, source, Reassembly::kGroup), 0s);
  }
  reassembly.progress(key(4, 4, Reassembly::kGroup), 0, 1500ms);
  EXPECT_TRUE(reassembly.admit(key(5, 5), kLargestWhole, true, 2s));
  EXPECT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{3}));
}

/// At 8 kB/s four packets of ten megabytes held all the room for twenty minutes.
TEST(Reassembly, ALargePacketThatWouldTakeTooLongMakesRoom) {
  constexpr std::size_t kLarge = 10'000'000;
  Reassembly reassembly(kLarge);
  for (std::uint8_t source = 1; source <= 4; ++source) reassembly.admit(key(source, source), kLarge, true, 0s);
  for (Time now = 0s; now <= 10s; now += 100ms) {
    for (std::uint8_t source = 1; source <= 4; ++source) {
      reassembly.progress(key(source, source), source == 4 ? 11'000 : 9'000, now);
    }
  }
  EXPECT_TRUE(reassembly.admit(key(5, 5), kLarge, true, 10s));
  EXPECT_EQ(evicted(reassembly), (std::vector<std::uint32_t>{3}));
  EXPECT_FALSE(reassembly.stalled(key(1, 1), 10s)) << "no reason to doubt it";
}

/// A first segment that claims to be of a packet of the largest size.
wire::Data forged_segment(const Host& destination, const Host& source) {
  wire::Data data = data_for(destination, source);
  data.total = kLargestWhole;
  data.segment_size = 100;
  data.octets.assign(100, 0);
  return data;
}

EngineOptions with_little_room() {
  EngineOptions options;
  options.max_packet_size = kLargestWhole;
  return options;
}

/// Four such frames held all the room for a minute.
TEST(Reassembly, FourForgedFramesDoNotHoldIt) {
  Stage stage(with_little_room());
  for (std::size_t i = 0; i < 4; ++i) stage.say(stage.neighbor(i), forged_segment(stage.self(), stage.neighbor(i)));
  Host& honest = stage.neighbor(9);
  stage.run_for(2500ms);
  wire::Data data = forged_segment(stage.self(), honest);
  for (data.index = 0; data.index < kLargestWhole / 100; ++data.index) stage.say(honest, data);
  stage.run_for(10ms);
  EXPECT_GE(stage.team.engine(0).statistics().frames_dropped.malformed, 1u) << "the image is zeros, but it is complete";
}

TEST(Reassembly, SegmentsNoLinkCarriesAreMalformed) {
  Stage stage(with_little_room());
  Host& forger = stage.neighbor(0);
  wire::Data data = forged_segment(stage.self(), forger);
  data.segment_size = 65'000;
  data.index = 1;
  data.octets.assign(35'000, 0);
  stage.say(forger, data);
  data.segment_size = 1;
  data.octets.assign(1, 0);
  stage.say(forger, data);
  EXPECT_EQ(stage.malformed(), 2u);
}

TEST(Reassembly, WantOfRoomIsToldOnce) {
  Stage stage(with_little_room());
  for (std::size_t i = 0; i < 4; ++i) stage.say(stage.neighbor(i), forged_segment(stage.self(), stage.neighbor(i)));
  Host& honest = stage.neighbor(9);
  stage.run_for(100ms);
  stage.forget();
  wire::Data data = forged_segment(stage.self(), honest);
  for (data.index = 0; data.index < 40; ++data.index) {
    stage.say(honest, data);
    stage.run_for(100us);
  }
  stage.run_for(10ms);
  std::vector<wire::RefusedPacket> refused;
  for (const auto& [at, frame] : stage.frames()) {
    if (frame.bytes[1] != static_cast<std::uint8_t>(wire::FrameType::kTransportAcknowledgment)) continue;
    const auto acknowledgment = wire::read_transport_acknowledgment(wire::open_body(frame.bytes).value()).value();
    if (acknowledgment.destination != honest.address) continue;
    refused.insert(refused.end(), acknowledgment.refused.begin(), acknowledgment.refused.end());
  }
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused[0].packet, data.packet);
}

/// Six packets for one base with room for four.
TEST(Reassembly, SixRobotsSendAMegabyteEachToOneBaseAtOnce) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    MediumOptions lossy;
    lossy.loss = 0.1;
    Team team(lossy, seed);
    EngineOptions options = without_groups();
    options.max_packet_size = 1'000'000;
    for (int robot = 0; robot <= 6; ++robot) team.add(options, robot * 0.5);
    team.run_for(2s);
    std::vector<Bytes> payloads;
    std::vector<SendId> ids;
    for (std::size_t robot = 1; robot <= 6; ++robot) {
      payloads.push_back(noise(999'900, seed * 10 + robot));
      ids.push_back(team.send(robot, "robot_0", payloads.back(), Priority::kBulk));
    }
    team.run_until_done([&] { return team.received(0).size() == 6; }, 60s);
    team.run_for(1s);
    ASSERT_EQ(team.received(0).size(), 6u) << "seed " << seed;
    for (std::size_t robot = 1; robot <= 6; ++robot) {
      ASSERT_NE(team.finished(robot, ids[robot - 1]), nullptr);
      EXPECT_TRUE(team.finished(robot, ids[robot - 1])->delivered) << team.finished(robot, ids[robot - 1])->reason;
    }
    for (const Team::Received& received : team.received(0)) {
      const std::size_t robot = received.packet.source.back() - '0';
      EXPECT_TRUE(received.packet.payload == payloads[robot - 1]) << "seed " << seed << ", robot " << robot;
    }
  }
}

/// One sender and one receiver, joined by hand.
struct Joined {
  Joined() { sender.add(1, image, 1000, 0s); }
  /// The next `count` segments arrive; fewer if the sender has no more.
  int pass(int count) {
    int passed = 0;
    for (; passed < count && sender.has_segment(); ++passed) {
      for (auto& complete : receiver.take(sender.next_segment(now), now)) arrived.push_back(complete.image);
    }
    return passed;
  }
  void acknowledge() { sender.acknowledged(receiver.acknowledge(2), now); }
  void later(Time by) {
    now += by;
    EXPECT_TRUE(sender.expire(10, now, random).empty());
  }

  const transport::Image image = std::make_shared<Bytes>(noise(90'000));
  Reassembly reassembly{kLargestWhole};
  transport::StreamReceiver receiver{{2, 0, 0, 0, 0, 1}, 7, kLargestWhole, reassembly};
  transport::StreamSender sender{2, 1, transport::StreamSender::kWindow};
  std::vector<Bytes> arrived;
  Time now{0};
  Random random{1};
};

TEST(Reassembly, APacketThatHadToMakeRoomIsBegunAnew) {
  Joined joined;
  joined.pass(40);
  joined.acknowledge();
  const wire::TransportAcknowledgment stale = joined.receiver.acknowledge(2);
  joined.receiver.evicted(2, 1, joined.now);
  EXPECT_EQ(joined.receiver.due(2), joined.now) << "the sender has to be told";
  joined.pass(5);
  joined.acknowledge();
  EXPECT_EQ(joined.pass(1), 0) << "not at once";
  joined.later(transport::StreamSender::kRoomRetry);
  EXPECT_EQ(joined.pass(100), 1) << "one segment asks";
  joined.sender.acknowledged(stale, joined.now);
  joined.acknowledge();
  EXPECT_EQ(joined.pass(100), 89);
  ASSERT_EQ(joined.arrived.size(), 1u);
  EXPECT_TRUE(joined.arrived[0] == *joined.image);
  joined.acknowledge();
  EXPECT_TRUE(joined.sender.idle());
}

TEST(Reassembly, ALostRefusalIsToldAgain) {
  Joined joined;
  joined.pass(40);
  joined.acknowledge();
  joined.receiver.evicted(2, 1, joined.now);
  joined.receiver.acknowledge(2);  // lost
  joined.pass(50);
  EXPECT_TRUE(joined.arrived.empty()) << "without the first segments there is no packet";
  joined.acknowledge();
  joined.later(transport::StreamSender::kRoomRetry);
  joined.pass(1);
  joined.acknowledge();
  joined.pass(100);
  ASSERT_EQ(joined.arrived.size(), 1u);
  EXPECT_TRUE(joined.arrived[0] == *joined.image);
}

/// Each refusal put off the timer that would have repeated it, and the two waited for one another for a minute.
TEST(Reassembly, ALostSegmentIsRepeatedWhileALaterPacketWaitsForRoom) {
  Joined joined;
  for (const SendId later : {2, 3}) joined.sender.add(later, joined.image, 1000, 0s);
  joined.pass(89);
  joined.sender.next_segment(joined.now);  // lost, the last one of the first packet
  joined.pass(90);
  joined.acknowledge();
  for (int round = 0; round < 5; ++round) {
    joined.pass(90);
    joined.acknowledge();
    joined.later(transport::StreamSender::kRoomRetry);
  }
  EXPECT_EQ(joined.arrived.size(), 3u);
}

TEST(Reassembly, ASendWithoutRoomFailsAfterAMinute) {
  Joined joined;
  std::vector<transport::StreamSender::GivenUp> given_up;
  while (given_up.empty() && joined.now < 100s) {
    wire::TransportAcknowledgment acknowledgment;
    if (joined.sender.has_segment()) acknowledgment.refused = {{1, joined.sender.next_segment(joined.now).attempt}};
    joined.sender.acknowledged(acknowledgment, joined.now);
    joined.now = std::max(joined.now + 1ms, joined.sender.next_deadline());
    given_up = joined.sender.expire(10, joined.now, joined.random);
  }
  ASSERT_EQ(given_up.size(), 1u);
  EXPECT_TRUE(given_up[0].no_room);
  EXPECT_GE(joined.now, transport::StreamSender::kRoomPatience);
  EXPECT_LT(joined.now, transport::StreamSender::kRoomPatience + 1s);
  EXPECT_TRUE(joined.sender.idle());
}

/// It was held for ever: nobody told the receiver that the packet before it would not come.
TEST(Reassembly, APacketBehindOneGivenUpForWantOfRoomIsDelivered) {
  Joined joined;
  const Reassembly::Key others[] = {key(20, 1), key(21, 1), key(22, 1), key(23, 1)};
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(joined.reassembly.admit(others[i], i < 3 ? kLargestWhole : 70'000, true, 0s));
  const transport::Image text = std::make_shared<Bytes>(noise(200));
  joined.sender.add(2, text, 1000, 0s);
  std::vector<transport::StreamSender::GivenUp> given_up;
  std::vector<SendId> finished;
  for (; finished.empty() && joined.now < 70s; joined.now += 10ms) {
    for (const Reassembly::Key& other : others) joined.reassembly.progress(other, 1000, joined.now);
    joined.pass(200);
    if (joined.receiver.due(2) <= joined.now) {
      finished = joined.sender.acknowledged(joined.receiver.acknowledge(2), joined.now);
    }
    for (const auto& packet : joined.sender.expire(10, joined.now, joined.random)) given_up.push_back(packet);
  }
  ASSERT_EQ(given_up.size(), 1u);
  EXPECT_TRUE(given_up[0].no_room);
  EXPECT_EQ(finished, std::vector<SendId>{2});
  ASSERT_EQ(joined.arrived.size(), 1u);
  EXPECT_TRUE(joined.arrived[0] == *text);
}

}  // namespace
}  // namespace adhoc_communication
