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
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, std::nullopt, 1s);
  directory.life_sign(other, "robot_7", 2, 1, 2, std::nullopt, 1s);
  EXPECT_EQ(directory.address_of("robot_7"), other);
  directory.life_sign(kRobot, "robot_7", 1, 5, 3, std::nullopt, 6s);
  directory.expire(9s);
  EXPECT_EQ(directory.address_of("robot_7"), kRobot) << "the other one is lost";
  directory.life_sign(kRobot, "robot_9", 1, 6, 3, std::nullopt, 9s);
  EXPECT_EQ(directory.address_of("robot_9"), kRobot);
  EXPECT_EQ(directory.address_of("robot_7"), other) << "where it was last";
  directory.expire(200s);
  EXPECT_FALSE(directory.address_of("robot_7"));
}

TEST(RobotDirectory, TheWayToAFarRobotIsByWhoToldOfItLastOverAGoodLink) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress a = {0x02, 0, 0, 0, 0, 1}, b = {0x02, 0, 0, 0, 0, 2};
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, std::nullopt, 1s);
  EXPECT_FALSE(directory.teller_of(kRobot)) << "over a bad link";
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, a, 1s);
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, b, 1s);
  EXPECT_EQ(directory.teller_of(kRobot), a) << "the first of those with the same life sign";
  directory.life_sign(kRobot, "robot_7", 1, 2, 3, std::nullopt, 2s);
  EXPECT_EQ(directory.teller_of(kRobot), a);
  directory.life_sign(kRobot, "robot_7", 1, 2, 4, b, 2s);
  EXPECT_EQ(directory.teller_of(kRobot), b);
  directory.life_sign(kRobot, "robot_7", 1, 1, 2, a, 2s);
  EXPECT_EQ(directory.teller_of(kRobot), b) << "what is old says nothing";
  directory.life_sign(kRobot, "robot_7", 1, 3, 1, b, 3s);
  EXPECT_FALSE(directory.teller_of(kRobot)) << "it is near";
  directory.life_sign(kRobot, "robot_7", 2, 1, 3, std::nullopt, 20s);
  EXPECT_FALSE(directory.teller_of(kRobot)) << "of another run nobody has told yet";
}

TEST(RobotDirectory, ANameIsThereOnceAndAsLongAsOneOfItsRadiosIs) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress other = {0x02, 0, 0, 0, 0, 8};
  directory.life_sign(kRobot, "robot_7", 1, 1, 1, std::nullopt, 1s);
  directory.life_sign(other, "robot_7", 2, 1, 1, std::nullopt, 2s);
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
