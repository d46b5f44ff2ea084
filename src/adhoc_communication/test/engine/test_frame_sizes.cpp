// Robots whose interfaces take frames of different lengths.
#include <gtest/gtest.h>

#include "payloads.hpp"
#include "simulation/team.hpp"
#include "transport/segment_size.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

/// Robots in a row, each with an MTU of its own.
Team row_with_mtus(const std::vector<int>& mtus, double loss = 0.0, std::uint64_t seed = 1) {
  MediumOptions medium;
  medium.loss = loss;
  Team team(medium, seed);
  for (std::size_t i = 0; i < mtus.size(); ++i) {
    EngineOptions options;
    options.mtu = mtus[i];
    team.add(options, 8.0 * static_cast<double>(i));
  }
  team.run_for(3s);
  return team;
}

/// How long the packet takes to be there; nothing if it fails.
std::optional<Time> delivery(Team& team, const std::string& destination, std::size_t octets, Time patience = 60s) {
  const Time begin = team.now();
  const SendId id = team.send(0, destination, noise(octets));
  if (!team.run_until_done([&] { return team.finished(0, id) != nullptr; }, patience)) {
    ADD_FAILURE() << "neither arrives nor fails";
    return std::nullopt;
  }
  if (!team.finished(0, id)->delivered) {
    ADD_FAILURE() << team.finished(0, id)->reason;
    return std::nullopt;
  }
  return team.now() - begin;
}

TEST(FrameSizes, PacketIsCutToWhatTheReceiverTakes) {
  for (const int mtu : {1400, 1280, 1000, 576, 400}) {
    Team team = row_with_mtus({1500, mtu});
    const auto time = delivery(team, "robot_1", 20'000);
    ASSERT_TRUE(time) << mtu;
    EXPECT_LE(*time, 15s) << mtu;
    EXPECT_EQ(team.received(1).back().packet.payload, noise(20'000));
  }
}

TEST(FrameSizes, PacketIsCutToWhatTheWayTakes) {
  for (const auto& mtus :
       std::vector<std::vector<int>>{{1500, 1500, 576}, {1500, 1000, 1500}, {1500, 1500, 400, 1500}}) {
    Team team = row_with_mtus(mtus);
    const auto time = delivery(team, "robot_" + std::to_string(mtus.size() - 1), 20'000);
    ASSERT_TRUE(time);
    EXPECT_LE(*time, 20s);
  }
}

TEST(FrameSizes, WhatWasLearntServesTheNextPackets) {
  Team team = row_with_mtus({1500, 576});
  ASSERT_TRUE(delivery(team, "robot_1", 20'000));
  EXPECT_LE(delivery(team, "robot_1", 20'000).value_or(1min), 1s);
}

TEST(FrameSizes, GroupPacketReachesAMemberWithShorterFrames) {
  Team team = row_with_mtus({1500, 576});
  EXPECT_LE(delivery(team, "mc_robot_0", 20'000).value_or(1min), 30s);
  EXPECT_EQ(team.received(1).back().packet.payload, noise(20'000));
}

TEST(FrameSizes, LifetimeEndsASendWhoseFramesAreTooLong) {
  Team team = row_with_mtus({1500, 576});
  SendRequest request{"robot_1", "topic", 'S', noise(20'000)};
  request.lifetime = 1s;
  const SendId id = team.send(0, request);
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 2s));
  EXPECT_EQ(team.finished(0, id)->reason, "not delivered within its lifetime of 1 s");
}

TEST(FrameSizes, LongFramesComeBackAfterAPauseOfTheAir) {
  Team team = row_with_mtus({1500, 1500});
  const SendId id = team.send(0, "robot_1", noise(2'000'000));
  team.run_for(50ms);
  team.set_position(1, 1000.0, 0.0);
  team.run_for(3s);
  team.set_position(1, 8.0, 0.0);
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 20s));
  team.run_for(11s);
  std::size_t longest = 0;
  team.on_transmission = [&](std::size_t, const Frame& frame) { longest = std::max(longest, frame.bytes.size()); };
  ASSERT_TRUE(delivery(team, "robot_1", 20'000));
  EXPECT_GE(longest, 1400u);
}

TEST(SegmentSizes, AreHalvedDownToTheShortestAndForgotten) {
  transport::SegmentSize sizes;
  EXPECT_EQ(sizes.of_packet(1400, 0s), 1400);
  EXPECT_EQ(sizes.shorter(1400, 0s), 700);
  EXPECT_EQ(sizes.of_packet(1400, 9s), 700);
  EXPECT_EQ(sizes.of_packet(1400, 10s), 1400);
  EXPECT_EQ(sizes.shorter(1400, 10s), 700);
  EXPECT_EQ(sizes.of_packet(1400, 49s), 700);
  EXPECT_EQ(sizes.shorter(700, 50s), 350);
  EXPECT_EQ(sizes.shorter(350, 50s), transport::SegmentSize::kShortest);
  EXPECT_FALSE(sizes.shorter(transport::SegmentSize::kShortest, 50s));
  sizes.arrived(200);
  EXPECT_EQ(sizes.of_packet(1400, 51s), transport::SegmentSize::kShortest);
  sizes.arrived(700);
  EXPECT_EQ(sizes.of_packet(1400, 51s), 1400);
}

TEST(SegmentSizes, ShortestFitsTheSmallestMtu) {
  constexpr std::size_t kSmallestMtu = 400;
  EXPECT_LE(transport::SegmentSize::kShortest + wire::kDataHeaderSize + wire::kHeaderSize + wire::kTagSize,
            kSmallestMtu);
}

}  // namespace
}  // namespace adhoc_communication
