// Where the robot of a name is.
#include <gtest/gtest.h>

#include "routing/robot_directory.hpp"

namespace adhoc_communication::routing {
namespace {

using namespace std::chrono_literals;

const MacAddress kRobot = {0x02, 0, 0, 0, 0, 7};
const MacAddress kTeller = {0x02, 0, 0, 0, 0, 1};

TEST(RobotDirectory, OfSeveralRadiosOfANameTheLivingAndNearestCounts) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress other = {0x02, 0, 0, 0, 0, 8};
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, kTeller, false, 1s);
  directory.life_sign(other, "robot_7", 2, 1, 2, kTeller, false, 1s);
  EXPECT_EQ(directory.address_of("robot_7"), other);
  directory.life_sign(kRobot, "robot_7", 1, 5, 3, kTeller, false, 6s);
  directory.expire(9s);
  EXPECT_EQ(directory.address_of("robot_7"), kRobot) << "the other one is lost";
  directory.life_sign(kRobot, "robot_9", 1, 6, 3, kTeller, false, 9s);
  EXPECT_EQ(directory.address_of("robot_9"), kRobot);
  EXPECT_EQ(directory.address_of("robot_7"), other) << "where it was last";
  directory.expire(200s);
  EXPECT_FALSE(directory.address_of("robot_7"));
}

TEST(RobotDirectory, TheWayToAFarRobotIsByWhoToldOfItLastOverAGoodLink) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress a = kTeller, b = {0x02, 0, 0, 0, 0, 2};
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, kTeller, false, 1s);
  EXPECT_FALSE(directory.teller_of(kRobot)) << "over a bad link";
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, a, true, 1s);
  directory.life_sign(kRobot, "robot_7", 1, 1, 3, b, true, 1s);
  EXPECT_EQ(directory.teller_of(kRobot), a) << "the first of those with the same life sign";
  directory.life_sign(kRobot, "robot_7", 1, 2, 3, kTeller, false, 2s);
  EXPECT_EQ(directory.teller_of(kRobot), a);
  directory.life_sign(kRobot, "robot_7", 1, 2, 4, b, true, 2s);
  EXPECT_EQ(directory.teller_of(kRobot), b);
  directory.life_sign(kRobot, "robot_7", 1, 1, 2, a, true, 2s);
  EXPECT_EQ(directory.teller_of(kRobot), b) << "what is old says nothing";
  directory.life_sign(kRobot, "robot_7", 1, 3, 1, kRobot, true, 3s);
  EXPECT_FALSE(directory.teller_of(kRobot)) << "it is near";
  directory.life_sign(kRobot, "robot_7", 2, 1, 3, kTeller, false, 20s);
  EXPECT_FALSE(directory.teller_of(kRobot)) << "of another run nobody has told yet";
}

TEST(RobotDirectory, ANameIsThereOnceAndAsLongAsOneOfItsRadiosIs) {
  LivingRuns runs;
  RobotDirectory directory(runs, "self");
  const MacAddress other = {0x02, 0, 0, 0, 0, 8};
  directory.life_sign(kRobot, "robot_7", 1, 1, 1, kRobot, false, 1s);
  directory.life_sign(other, "robot_7", 2, 1, 1, other, false, 2s);
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

MacAddress numbered(std::size_t number) {
  return {0x06, 0, 0, 0, static_cast<std::uint8_t>(number >> 8), static_cast<std::uint8_t>(number)};
}

struct Told {
  /// So many robots by one neighbour.
  void tell(std::size_t first, std::size_t count, const MacAddress& teller, Time now) {
    for (std::size_t i = first; i < first + count; ++i) {
      directory.life_sign(numbered(i), "x" + std::to_string(i), 1, 1, 3, teller, true, now);
    }
  }
  bool hear(const MacAddress& robot, const std::string& name, Time now) {
    runs.heard(robot, 1, 1, now);
    directory.life_sign(robot, name, 1, 1, 1, robot, true, now);
    return directory.address_of(name) == robot;
  }
  LivingRuns runs;
  RobotDirectory directory{runs, "self"};
};

/// One neighbour filled it, and a new robot was unknown for a minute.
TEST(RobotDirectory, ANeighborTellsOfItsShare) {
  Told told;
  told.tell(0, 1040, kTeller, 1s);
  EXPECT_EQ(told.directory.size(), RobotDirectory::kMostOfATeller);
  EXPECT_TRUE(told.directory.address_of("x0")) << "who is known stays";
  const MacAddress other = {0x02, 0, 0, 0, 0, 2};
  told.tell(2000, 1, other, 1s);
  EXPECT_TRUE(told.directory.address_of("x2000"));
  EXPECT_FALSE(told.directory.learn(numbered(2001), "x2001", 1, 1, kTeller, 1s)) << "nor of one by a request";
  told.directory.expire(20s);
  told.tell(2002, 1, kTeller, 20s);
  EXPECT_TRUE(told.directory.address_of("x2002")) << "in the place of one that is lost";
  EXPECT_EQ(told.directory.size(), RobotDirectory::kMostOfATeller + 1);
}

TEST(RobotDirectory, WhoIsHeardIsTakenInWhateverIsToldOfOthers) {
  Told told;
  for (std::uint8_t teller = 1; teller <= 8; ++teller) told.tell(teller * 256u, 256, {2, 0, 0, 0, 0, teller}, 1s);
  EXPECT_EQ(told.directory.size(), RobotDirectory::kMostRobots);
  told.directory.take_changes();
  EXPECT_TRUE(told.hear(kRobot, "robot_7", 2s));
  EXPECT_EQ(told.directory.size(), RobotDirectory::kMostRobots);
  const std::vector<DirectoryChange> changes = told.directory.take_changes();
  ASSERT_EQ(changes.size(), 2u);
  EXPECT_FALSE(changes[0].appeared) << "who made room is lost";
  EXPECT_EQ(changes[1].robot, "robot_7");
  told.tell(9000, 300, kTeller, 2s);
  EXPECT_TRUE(told.directory.address_of("robot_7")) << "and stays";
}

TEST(RobotDirectory, OfThoseHeardTheOneHeardLongestAgoMakesRoom) {
  Told told;
  told.tell(5000, 100, kTeller, 1s);
  for (std::size_t i = 0; i < 600; ++i) EXPECT_TRUE(told.hear(numbered(i), "x" + std::to_string(i), 1s + i * 1ms));
  EXPECT_EQ(told.directory.size(), RobotDirectory::kMostHeard + 100);
  EXPECT_FALSE(told.directory.address_of("x0"));
  EXPECT_TRUE(told.directory.address_of("x599"));
  EXPECT_TRUE(told.directory.address_of("x5000"));
}

}  // namespace
}  // namespace adhoc_communication::routing
