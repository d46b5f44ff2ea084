// Restarts, duplication, reordering, corruption, hostile frames, full queues.
#include <gtest/gtest.h>

#include "diamond.hpp"
#include "finish.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "transport/hop_sender.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

/// A frame given up is left to the end-to-end repetition; with nothing outstanding silence means nothing.
TEST(HopSender, AGivenUpFrameDoesNotKillTheLink) {
  transport::HopSender sender(1, 0);
  sender.start({wire::FrameType::kData, text("x"), 0}, 1, 0ms);
  sender.expire(100ms);
  EXPECT_FALSE(sender.dead(10s));
}

TEST(Hardship, BoundaryLengthsArrive) {
  EngineOptions options;
  options.max_frame_size = 400;
  Team team;
  team.add_line(2, options);
  team.run_for(500ms);
  // Of 400 octets, 14 + 43 + 41 + 16 are headers and room for a tag; the packet's own header is 15 octets here.
  const std::size_t segment = 400 - 14 - 43 - 41 - 16;
  std::vector<Bytes> sent;
  for (const std::size_t segments : {1, 2, 3}) {
    for (const int difference : {-1, 0, 1}) {
      sent.push_back(noise(segments * segment - 15 + static_cast<std::size_t>(difference + 1) - 1, segments));
    }
  }
  sent.push_back({});
  SendId last = 0;
  for (const Bytes& payload : sent) last = team.send(0, "robot_1", payload);
  ASSERT_TRUE(finish(team, 0, last));
  ASSERT_EQ(team.received(1).size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(team.received(1)[i].packet.payload, sent[i]) << i;
}

TEST(Hardship, FramesNeverExceedTheLimit) {
  for (const int limit : {256, 1000, 1500, 2304}) {
    EngineOptions options;
    options.max_frame_size = limit;
    options.mtu = 1400;
    Team team;
    team.add_line(2, options);
    team.run_for(500ms);
    std::size_t longest = 0;
    team.on_transmission = [&](std::size_t, const Frame& frame) {
      if (frame.bytes[1] == 6) longest = std::max(longest, frame.bytes.size() + 14);
    };
    const SendId id = team.send(0, "robot_1", noise(20'000));
    ASSERT_TRUE(finish(team, 0, id));
    EXPECT_TRUE(team.finished(0, id)->delivered);
    EXPECT_LE(longest, static_cast<std::size_t>(std::min(limit, 1414)));
  }
}

TEST(Hardship, OrderAndOnceUnderDuplicationReorderingAndCorruption) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    MediumOptions medium;
    medium.loss = 0.1;
    medium.duplication = 0.1;
    medium.reordering = 0.1;
    medium.corruption = 0.05;
    Team team(medium, seed);
    team.add_line(4);
    team.run_for(2s);
    std::vector<Bytes> sent;
    SendId last = 0;
    for (std::size_t i = 0; i < 60; ++i) {
      sent.push_back(noise(i * 331 % 9000, i + 1));
      last = team.send(0, "robot_3", sent.back());
    }
    ASSERT_TRUE(finish(team, 0, last)) << "seed " << seed;
    team.run_for(1s);
    ASSERT_EQ(team.received(3).size(), sent.size()) << "seed " << seed;
    for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_EQ(team.received(3)[i].packet.payload, sent[i]);
  }
}

TEST(Hardship, ReceiverRestartsInMidTransfer) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    MediumOptions medium;
    medium.loss = 0.1;
    Team team(medium, seed);
    team.add_line(3);
    team.run_for(1s);
    const Bytes payload = noise(1'000'000, seed);
    const SendId id = team.send(0, "robot_2", payload, Priority::kBulk);
    team.run_for(Time(80ms) + Time(seed * 20'000'000));
    ASSERT_EQ(team.finished(0, id), nullptr);
    team.restart(2);
    ASSERT_TRUE(finish(team, 0, id)) << "seed " << seed;
    EXPECT_TRUE(team.finished(0, id)->delivered) << "seed " << seed << ": " << team.finished(0, id)->reason;
    team.run_for(1s);
    ASSERT_EQ(team.received(2).size(), 1u);
    EXPECT_EQ(team.received(2)[0].packet.payload, payload);
  }
}

TEST(Hardship, SenderRestartsInMidTransfer) {
  Team team;
  team.add_line(3);
  team.run_for(1s);
  team.send(0, "robot_2", noise(1'000'000), Priority::kBulk);
  team.run_for(100ms);
  team.restart(0);
  team.run_for(500ms);
  const SendId id = team.send(0, "robot_2", text("after the restart"), Priority::kBulk);
  ASSERT_TRUE(finish(team, 0, id));
  EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  team.run_for(1s);
  ASSERT_EQ(team.received(2).size(), 1u);
  EXPECT_EQ(text(team.received(2)[0].packet.payload), "after the restart");
}

TEST(Hardship, RelayDiesInMidTransferAndNothingIsLostOrDoubled) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    MediumOptions medium;
    medium.loss = 0.1;
    Diamond diamond(medium, seed);
    Team& team = diamond.team;
    const std::size_t& relay = diamond.relay;
    team.run_for(1s);
    std::vector<Bytes> sent;
    std::vector<SendId> ids;
    for (std::size_t i = 0; i < 10; ++i) {
      sent.push_back(noise(100'000, i + 1));
      ids.push_back(team.send(0, "robot_3", sent.back()));
    }
    team.run_for(120ms);
    ASSERT_NE(relay, 0u);
    team.kill(relay);
    ASSERT_TRUE(finish(team, 0, ids.back())) << "seed " << seed;
    for (const SendId id : ids) EXPECT_TRUE(team.finished(0, id)->delivered);
    ASSERT_EQ(team.received(3).size(), sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(team.received(3)[i].packet.payload, sent[i]);
  }
}

TEST(Hardship, SilentDestinationFailsWithReason) {
  Team team;
  team.add_line(3);
  team.run_for(1s);
  const SendId before = team.send(0, "robot_2", text("x"));
  ASSERT_TRUE(finish(team, 0, before));
  team.kill(2);
  const SendId id = team.send(0, "robot_2", text("y"));
  ASSERT_TRUE(finish(team, 0, id));
  EXPECT_FALSE(team.finished(0, id)->delivered);
  EXPECT_EQ(team.finished(0, id)->reason.find("no route to robot_2 after"), 0u) << team.finished(0, id)->reason;
}

TEST(Hardship, A4_11_RefusalsNameTheNumbers) {
  Team team;
  team.add_line(2);
  const auto reason = [&](const SendId id) {
    team.run_for(1ms);
    return team.finished(0, id) == nullptr ? "none" : team.finished(0, id)->reason;
  };
  EXPECT_EQ(reason(team.send(0, "robot_1", Bytes(12'000'000))), "packet of 12.0 MB exceeds max_packet_size of 10.0 MB");
  EXPECT_EQ(reason(team.send(0, "robot_0", {})), "the destination robot_0 is this robot itself");
  for (const char* name : {"no robot", "mc_ b\n"}) {  // neighbours would count each search for it as a malformed frame
    EXPECT_NE(reason(team.send(0, name, {})).find("cannot be the name of a robot"), std::string::npos) << name;
  }
  EXPECT_EQ(reason(team.send(0, "robot_1", {}, Priority::kNormal, "")), "the topic is empty");
  SendId last = 0;
  for (int i = 0; i < 257; ++i) last = team.send(0, "robot_8", {});
  EXPECT_EQ(reason(last), "send queue is full (256 packets waiting)");
}

TEST(Hardship, PositionDoesNotWaitBehindMap) {
  Team team;
  team.add_line(3);
  team.run_for(1s);
  team.send(0, "robot_2", noise(2'000'000), Priority::kBulk);
  team.run_for(150ms);
  const Time start = team.now();
  team.send(0, "robot_2", text("here"), Priority::kPosition);
  ASSERT_TRUE(team.run_until_done([&] { return !team.received(2).empty(); }, 2s));
  EXPECT_EQ(text(team.received(2)[0].packet.payload), "here");
  EXPECT_LE(team.now() - start, 10ms);
}

TEST(Hardship, ArtificialLossSlowsButDoesNotStop) {
  EngineOptions options;
  options.loss_ratio = 0.3;
  Team team;
  team.add_line(3, options);
  team.run_for(1s);
  const Bytes payload = noise(300'000);
  const SendId id = team.send(0, "robot_2", payload);
  ASSERT_TRUE(finish(team, 0, id));
  ASSERT_EQ(team.received(2).size(), 1u);
  EXPECT_EQ(team.received(2)[0].packet.payload, payload);
}

TEST(Hardship, WithoutHopRepetitionTheEndsStillRepeat) {
  EngineOptions options;
  options.num_link_retrans = 0;
  MediumOptions medium;
  medium.loss = 0.02;
  Team team(medium, 3);
  team.add_line(2, options);
  team.run_for(1s);
  const Bytes payload = noise(20'000);
  const SendId id = team.send(0, "robot_1", payload);
  ASSERT_TRUE(finish(team, 0, id, 60s));
  EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  ASSERT_EQ(team.received(1).size(), 1u);
}

/// Their questions came at the same instants for ever, and collided at the robot between them.
TEST(Hardship, WhoDoNotHearEachOtherDoNotAskInStep) {
  EngineOptions options;
  options.num_link_retrans = 0;
  MediumOptions medium;
  medium.contention = true;
  Team team(medium, 3);
  team.add_line(3, options);
  team.run_for(1s);
  const SendId left = team.send(0, "robot_1", noise(1000));
  const SendId right = team.send(2, "robot_1", noise(1000));
  ASSERT_TRUE(finish(team, 0, left) && finish(team, 2, right));
  EXPECT_TRUE(team.finished(0, left)->delivered) << team.finished(0, left)->reason;
  EXPECT_TRUE(team.finished(2, right)->delivered) << team.finished(2, right)->reason;
}

/// So did their requests for routes, and the copies for the robot between them that had missed those.
TEST(Hardship, A4_14_WhoDoNotHearEachOtherDoNotSearchInStep) {
  EngineOptions options;
  options.num_link_retrans = 0;
  MediumOptions medium;
  medium.contention = true;
  medium.bit_rate = 6e6;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Team team(medium, seed);
    team.add_line(3, options);
    team.run_for(3s);
    const SendId left = team.send(0, "robot_2", noise(100));
    const SendId right = team.send(2, "robot_0", noise(100));
    ASSERT_TRUE(finish(team, 0, left) && finish(team, 2, right)) << seed;
    EXPECT_TRUE(team.finished(0, left)->delivered) << seed << ": " << team.finished(0, left)->reason;
    EXPECT_TRUE(team.finished(2, right)->delivered) << seed << ": " << team.finished(2, right)->reason;
  }
}

TEST(Hardship, TenMegabytes) {
  Team team;
  team.add_line(2);
  team.run_for(1s);
  const Bytes payload = noise(9'999'000);
  const SendId id = team.send(0, "robot_1", payload, Priority::kBulk);
  ASSERT_TRUE(finish(team, 0, id));
  ASSERT_EQ(team.received(1).size(), 1u);
  EXPECT_EQ(team.received(1)[0].packet.payload, payload);
}

/// Random bodies under a valid header and checksum, from many senders: the engine stays sound and keeps working.
TEST(Hardship, A1_9_HostileFramesChangeNothingForOthers) {
  Team team;
  team.add_line(2);
  team.run_for(1s);
  Random random(11);
  for (int i = 0; i < 60'000; ++i) {
    wire::FrameHeader header;
    header.type = static_cast<wire::FrameType>(1 + random.next() % 9);
    header.flags = static_cast<std::uint8_t>(random.next() % 2 == 0 ? wire::kWantsAcknowledgment : 0);
    header.sender = {
        6, 6, 0, 0, static_cast<std::uint8_t>(random.next() % 2), static_cast<std::uint8_t>(random.next())};
    header.boot_id[0] = static_cast<std::uint8_t>(random.next() % 3);
    header.counter = random.next();
    header.next_hop = random.next() % 2 == 0 ? Team::address(0) : wire::kEverybody;
    header.link_sequence = static_cast<std::uint32_t>(random.next());
    Frame frame{header.next_hop, header.sender, wire::close_openly(header, noise(random.next() % 120, random.next()))};
    if (i % 5 == 0) frame.bytes.resize(random.next() % (frame.bytes.size() + 1));
    if (i % 7 == 0 && !frame.bytes.empty()) frame.bytes[random.next() % frame.bytes.size()] ^= 0x10;
    team.engine(0).receive(frame, team.now());
    if (i % 50 == 0) team.run_for(1ms);
  }
  EXPECT_GT(team.engine(0).statistics().frames_dropped.malformed, 10'000u);
  EXPECT_LE(team.engine(0).routes().size(), 1024u);
  team.run_for(10s);
  const Bytes payload = noise(50'000);
  const SendId id = team.send(0, "robot_1", payload);
  ASSERT_TRUE(finish(team, 0, id));
  EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
}

TEST(Options, OutOfRangeNamesTheOption) {
  EngineOptions options;
  options.robot_name = "robot_0";
  EXPECT_NO_THROW(validate(options));
  options.num_rreq = 0;
  try {
    validate(options);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "parameter num_rreq is 0, but has to be between 1 and 100");
  }
}

}  // namespace
}  // namespace adhoc_communication
