// What a link is thought to lose, from its first beacon on.
#include <gtest/gtest.h>

#include "routing/neighbors.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using routing::Neighbors;

constexpr wire::NeighborTag kSelf = 7;
constexpr wire::BootTag kBoot = 1;
const MacAddress kNeighbor{6, 6, 0, 0, 0, 1};

class LinkEstimate : public testing::Test {
 protected:
  /// The next `lost` beacons of the neighbour are lost, one is heard; it says that it misses as many as this robot
  /// does.
  void hear(int lost = 0) {
    number_ = static_cast<std::uint16_t>(number_ + 1 + lost);
    now_ += 250ms * (1 + lost);
    neighbors_.heard(kNeighbor, kBoot, now_);
    wire::Beacon beacon;
    beacon.number = number_;
    beacon.interval_ms = interval_ms_;
    beacon.heard_count = 1;
    beacon.heard.push_back({kSelf, static_cast<std::uint8_t>(255 * loss_from())});
    neighbors_.beacon(kNeighbor, beacon, kSelf, now_);
  }
  double loss_from() const { return neighbors_.find(kNeighbor)->loss_from; }

  Timings timings_ = robot_timings();
  Neighbors neighbors_{timings_, 250ms};
  Time now_{0};
  std::uint16_t number_ = 0;
  std::uint16_t interval_ms_ = 250;
};

/// Robots come into reach where links are bad, and the first beacon made each link a perfect one.
TEST_F(LinkEstimate, TheFirstBeaconMakesNoPerfectLink) {
  hear();
  EXPECT_NEAR(loss_from(), 1.0 / 3.0, 1e-9);
  for (int i = 0; i < 40; ++i) hear();
  EXPECT_LE(loss_from(), 0.01);
  EXPECT_EQ(neighbors_.cost(kNeighbor), routing::kPerfectHop);
}

/// A link that goes bad, as the robot drives off, is known within two seconds.
TEST_F(LinkEstimate, FollowsARobotThatDrivesOff) {
  for (int i = 0; i < 40; ++i) hear();
  for (int i = 0; i < 4; ++i) hear(1);
  EXPECT_GE(loss_from(), 0.3);
}

TEST_F(LinkEstimate, BothDirectionsCost) {
  for (int i = 0; i < 100; ++i) hear(i % 2);
  const double loss = loss_from();
  EXPECT_NEAR(neighbors_.cost(kNeighbor), routing::kPerfectHop / ((1 - loss) * (1 - loss)), 2.0);
}

/// A robot on the move asked each neighbour that it left behind, several times each, although two seconds of silence
/// end the routes by themselves.
TEST_F(LinkEstimate, OnlySlowBeaconsAreAskedFor) {
  for (int i = 0; i < 40; ++i) hear();
  EXPECT_TRUE(neighbors_.doubtful(now_ + 1900ms).empty());
  interval_ms_ = 1000;
  hear();
  EXPECT_TRUE(neighbors_.doubtful(now_ + 1900ms).empty());
  EXPECT_EQ(neighbors_.doubtful(now_ + 2100ms), std::vector<MacAddress>{kNeighbor});
}

}  // namespace
}  // namespace adhoc_communication
