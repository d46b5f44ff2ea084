// Packets of one frame for most of the team: everybody passes them on, members say that they have them.
#include <gtest/gtest.h>

#include <algorithm>

#include "finish.hpp"
#include "payloads.hpp"
#include "random_waypoint.hpp"
#include "simulation/team.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

bool is(const Frame& frame, FrameType type) { return frame.bytes[1] == static_cast<std::uint8_t>(type); }

/// Counts what robots send for the group of robot 0, and packets for one member.
struct Flood {
  explicit Flood(const MediumOptions& medium = {}, std::uint64_t seed = 1) : team(medium, seed) {
    team.on_transmission = [this](std::size_t, const Frame& frame) {
      data += is(frame, FrameType::kGroupData);
      receipts += is(frame, FrameType::kGroupReceipts);
      trees += is(frame, FrameType::kGroupActivation);
      copies += is(frame, FrameType::kData) && frame.bytes.size() > 900;
    };
  }
  /// In order, whole, and once.
  void expect_all_at(const std::vector<std::size_t>& robots) {
    for (const std::size_t robot : robots) {
      ASSERT_EQ(team.received(robot).size(), sent.size()) << "robot " << robot;
      for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_EQ(team.received(robot)[i].packet.payload, noise(1000, i));
    }
  }
  void send() { sent.push_back(team.send(0, "mc_robot_0", noise(1000, sent.size()))); }
  void finish_all() {
    for (const SendId id : sent) {
      ASSERT_TRUE(finish(team, 0, id));
      EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
    }
  }

  Team team;
  std::vector<SendId> sent;
  int data = 0;
  int receipts = 0;
  int trees = 0;
  int copies = 0;
};

/// One frame and their reports, which ask for what they miss.
TEST(GroupFlood, WhereAllHearTheRootTheTreeIsTheLesserEffort) {
  Flood flood;
  for (int robot = 0; robot < 8; ++robot) flood.team.add({}, robot * 0.5, 0);
  flood.team.run_for(5s);
  flood.data = 0;
  flood.send();
  flood.finish_all();
  flood.expect_all_at({1, 2, 3, 4, 5, 6, 7});
  EXPECT_EQ(flood.data, 1);
  EXPECT_EQ(flood.trees, 7);
  EXPECT_EQ(flood.receipts, 0);
}

/// Who hears most of the others does not pass on what these have heard as well.
TEST(GroupFlood, InACrowdFewPassItOn) {
  Flood flood;
  for (int robot = 0; robot < 18; ++robot) flood.team.add({}, robot, 0);
  flood.team.run_for(10s);
  flood.data = 0;
  flood.send();
  flood.finish_all();
  flood.expect_all_at({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17});
  EXPECT_EQ(flood.trees, 0);
  EXPECT_LE(flood.data, 6);
}

TEST(GroupFlood, AlongALineEachPassesItOnAndGathersReceipts) {
  Flood flood;
  flood.team.add_line(6);
  flood.team.run_for(10s);
  flood.data = 0;
  flood.send();
  flood.finish_all();
  flood.expect_all_at({1, 2, 3, 4, 5});
  EXPECT_EQ(flood.team.received(5)[0].packet.hops, 5);
  EXPECT_EQ(flood.data, 5) << "the last one has nobody behind it";
  EXPECT_EQ(flood.receipts, 5) << "each tells of those behind it as well";
  EXPECT_EQ(flood.copies, 0);
}

TEST(GroupFlood, RepeatsUntilTheNextOneIsHeard) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    MediumOptions medium;
    medium.loss = 0.3;
    Flood flood(medium, seed);
    flood.team.add_line(6);
    flood.team.run_for(10s);
    for (int packet = 0; packet < 10; ++packet) {
      flood.send();
      flood.team.run_for(500ms);
    }
    flood.finish_all();
    flood.expect_all_at({1, 2, 3, 4, 5});
  }
}

/// All behind a link that had lost the packet were sent copies, each over that link: 39 frames.
TEST(GroupFlood, ACopyIsPassedOnToThoseNearby) {
  MediumOptions medium;
  medium.bit_rate = 1e6;
  Flood flood(medium);
  std::vector<std::size_t> members;
  for (std::size_t robot = 0; robot < 20; ++robot) {
    const auto place = static_cast<double>(robot);
    flood.team.add({}, robot < 2 ? 8.0 * place : 16.0 + 0.05 * place, 0);
    if (robot > 0) members.push_back(robot);
  }
  flood.team.run_for(10s);
  flood.send();
  flood.finish_all();
  flood.team.medium().set_link_loss(0, 1, 1.0);
  flood.send();
  flood.team.run_for(200ms);
  flood.team.medium().set_link_loss(0, 1, std::nullopt);
  flood.copies = 0;
  flood.finish_all();
  flood.expect_all_at(members);
  EXPECT_GT(flood.copies, 0) << "otherwise this tests nothing";
  EXPECT_LT(flood.copies, 20);
}

/// Robot 1 is heard by the root no more, and 2 got the packets from 1: what 1 told 2 then, by the route, came back to
/// 1, and got no farther. The root sent copies to all behind.
TEST(GroupFlood, ReceiptsThatGoByTheRouteAreNotGivenBack) {
  Flood flood;
  const std::vector<std::pair<std::size_t, std::size_t>> links{{0, 1}, {1, 2}, {2, 3}, {3, 0}, {1, 4}, {1, 5}, {1, 6}};
  for (std::size_t robot = 0; robot < 7; ++robot) flood.team.add({}, static_cast<double>(robot), 0);
  for (std::size_t a = 0; a < 7; ++a) {
    for (std::size_t b = a + 1; b < 7; ++b) {
      const bool linked = std::find(links.begin(), links.end(), std::pair(a, b)) != links.end() ||
                          std::find(links.begin(), links.end(), std::pair(b, a)) != links.end();
      if (!linked) flood.team.medium().set_link_loss(a, b, 1.0);
    }
  }
  flood.team.medium().set_link_loss(2, 3, 0.3);
  flood.team.run_for(10s);
  flood.send();
  flood.finish_all();
  flood.team.medium().set_one_way_loss(1, 0, 1.0);
  flood.team.run_for(10s);
  const SendId asks = flood.team.send(1, Team::name(0), noise(10, 0));
  ASSERT_TRUE(finish(flood.team, 1, asks));
  flood.copies = 0;
  for (int packet = 0; packet < 5; ++packet) {
    flood.send();
    flood.team.run_for(1s);
  }
  flood.finish_all();
  flood.expect_all_at({1, 2, 4, 5, 6});
  EXPECT_EQ(flood.copies, 0);
}

/// Of what a copy for one member may overtake nothing is lost.
TEST(GroupFlood, PacketsThatFollowEachOtherCloselyComeInOrderOverABreak) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    MediumOptions medium;
    medium.loss = 0.2;
    medium.bit_rate = 2e6;
    Flood flood(medium, seed);
    for (const auto& [x, y] : {std::pair(0.0, 0.0), {7.0, 4.0}, {7.0, -4.0}, {14.0, 0.0}, {22.0, 0.0}}) {
      flood.team.add({}, x, y);
    }
    flood.team.run_for(5s);
    for (int packet = 0; packet < 300; ++packet) {
      if (packet == 50) flood.team.medium().set_link_loss(1, 3, 1.0);
      if (packet == 150) flood.team.medium().set_link_loss(1, 3, std::nullopt);
      if (packet == 200) flood.team.medium().set_link_loss(2, 3, 1.0);
      flood.send();
      flood.team.run_for(20ms);
    }
    flood.finish_all();
    flood.expect_all_at({1, 2, 3, 4});
  }
}

/// Some are too large for one frame and take the tree; a third of the floods finds no room, and does as well. In two of
/// these seeds a relay that passed on what it had heard before it had its place told those behind it to begin there.
TEST(GroupFlood, KeepsTheOrderBetweenFloodsAndTheTree) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 22u, 134u}) {
    MediumOptions medium;
    medium.loss = 0.3;
    medium.bit_rate = 5e6;
    Flood flood(medium, seed);
    flood.team.add_line(6);
    flood.team.run_for(10s);
    std::vector<Bytes> payloads;
    std::vector<SendId> sent;
    Random random(seed);
    for (int packet = 0; packet < 100; ++packet) {
      payloads.push_back(noise(random.chance(0.3) ? 8000 : 300, payloads.size()));
      sent.push_back(flood.team.send(0, "mc_robot_0", payloads.back()));
      flood.team.run_for(random.delay(20ms));
    }
    for (const SendId id : sent) {
      ASSERT_TRUE(finish(flood.team, 0, id));
      ASSERT_TRUE(flood.team.finished(0, id)->delivered)
          << "seed " << seed << ": " << flood.team.finished(0, id)->reason;
    }
    for (std::size_t robot = 1; robot < 6; ++robot) {
      ASSERT_EQ(flood.team.received(robot).size(), payloads.size()) << "seed " << seed << " robot " << robot;
      for (std::size_t i = 0; i < payloads.size(); ++i) {
        ASSERT_EQ(flood.team.received(robot)[i].packet.payload, payloads[i]) << "seed " << seed << " robot " << robot;
      }
    }
  }
}

}  // namespace
}  // namespace adhoc_communication
