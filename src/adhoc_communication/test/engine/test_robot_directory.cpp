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

TEST(RobotDirectory, ANameIsThereOnceAndAsLongAsOneOfItsRadiosIs) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress other = {0x02, 0, 0, 0, 0, 8};
  directory.life_sign(kRobot, "robot_7", 1, 1, 1, 1s);
  directory.life_sign(other, "robot_7", 2, 1, 1, 2s);
  EXPECT_EQ(directory.names(), std::vector<std::string>{"robot_7"});
  std::vector<std::pair<bool, wire::BootTag>> told;
  for (const DirectoryChange& change : directory.take_changes()) told.emplace_back(change.appeared, change.boot);
  EXPECT_EQ(told, (std::vector<std::pair<bool, wire::BootTag>>{{true, 1}, {false, 1}, {true, 2}}));
  directory.expire(6500ms);
  EXPECT_TRUE(directory.take_changes().empty()) << "only the former radio is silent";
  directory.expire(8s);
  ASSERT_EQ(directory.take_changes().size(), 1u);
  EXPECT_TRUE(directory.names().empty());
}

}  // namespace
}  // namespace adhoc_communication::routing
