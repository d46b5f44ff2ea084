// Packets over one and several hops: every one arrives, once, in order, bit for bit.
#include <gtest/gtest.h>

#include "payloads.hpp"
#include "simulation/team.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

TEST(Transfer, NeighborReceivesString) {
  Team team;
  team.add_line(2);
  const SendId id = team.send(0, "robot_1", text("hello"));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 2s));
  EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  ASSERT_EQ(team.received(1).size(), 1u);
  const PacketReceived& packet = team.received(1)[0].packet;
  EXPECT_EQ(packet.source, "robot_0");
  EXPECT_EQ(packet.topic, "topic");
  EXPECT_EQ(packet.payload_type, 'A');
  EXPECT_EQ(packet.hops, 1);
  EXPECT_EQ(text(packet.payload), "hello");
}

struct Case {
  std::size_t hops;
  double loss;
  bool compressible;
};

class Megabyte : public testing::TestWithParam<Case> {};

TEST_P(Megabyte, ArrivesBitForBit) {
  const Case& c = GetParam();
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    MediumOptions medium;
    medium.loss = c.loss;
    Team team(medium, seed);
    team.add_line(c.hops + 1);
    team.run_for(1s);
    const Bytes payload = c.compressible ? map_like(1'000'000) : noise(1'000'000, seed);
    const SendId id = team.send(0, Team::name(c.hops), payload, Priority::kBulk);
    ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 30s)) << "seed " << seed;
    ASSERT_TRUE(team.finished(0, id)->delivered) << "seed " << seed << ": " << team.finished(0, id)->reason;
    team.run_for(1s);
    ASSERT_EQ(team.received(c.hops).size(), 1u) << "seed " << seed;
    EXPECT_EQ(team.received(c.hops)[0].packet.payload, payload);
    EXPECT_EQ(team.received(c.hops)[0].packet.hops, c.hops);
  }
}

INSTANTIATE_TEST_SUITE_P(HopsAndLoss, Megabyte,
                         testing::Values(Case{1, 0.0, false}, Case{1, 0.1, false}, Case{1, 0.3, false},
                                         Case{3, 0.0, false}, Case{3, 0.1, false}, Case{3, 0.3, false},
                                         Case{1, 0.3, true}, Case{3, 0.3, true}),
                         [](const auto& info) {
                           return std::to_string(info.param.hops) + "Hops" +
                                  std::to_string(static_cast<int>(info.param.loss * 100)) + "Percent" +
                                  (info.param.compressible ? "Map" : "Noise");
                         });

}  // namespace
}  // namespace adhoc_communication
