// Where the robot of a name is.
#include <gtest/gtest.h>

#include "routing/robot_directory.hpp"

namespace adhoc_communication::routing {
namespace {

using namespace std::chrono_literals;

const MacAddress kRobot = {0x02, 0, 0, 0, 0, 7};
TEST(RobotDirectory, OfSeveralRadiosOfANameTheLivingAndNearestCounts) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress other = {0x02, 0, 0, 0, 0, 8};
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, 1s);
  directory.life_sign(other, "robot_7", 2, 1, 2, 1s);
  EXPECT_EQ(directory.address_of("robot_7"), other);
  directory.life_sign(kRobot, "robot_7", 1, 5, 3, 6s);
  directory.expire(9s);
  EXPECT_EQ(directory.address_of("robot_7"), kRobot) << "the other one is lost";
  directory.life_sign(kRobot, "robot_9", 1, 6, 3, 9s);
  EXPECT_EQ(directory.address_of("robot_9"), kRobot);
  EXPECT_EQ(directory.address_of("robot_7"), other) << "where it was last";
  directory.expire(200s);
  EXPECT_FALSE(directory.address_of("robot_7"));
}

}  // namespace
}  // namespace adhoc_communication::routing
