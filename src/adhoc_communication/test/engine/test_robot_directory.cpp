// Which runs of a robot are believed in.
#include <gtest/gtest.h>

#include "routing/robot_directory.hpp"

namespace adhoc_communication::routing {
namespace {

using namespace std::chrono_literals;

const MacAddress kRobot = {0x02, 0, 0, 0, 0, 7};
constexpr wire::BootTag kEnded = 1;
constexpr wire::BootTag kLiving = 2;

/// The living run was known, then late hearsay about the ended one displaced it.
struct Displaced {
  Displaced() {
    directory.life_sign(kRobot, "robot_7", kLiving, 1, 2, 10s);
    directory.life_sign(kRobot, "robot_7", kEnded, 30, 3, 10s);
  }
  /// Second by second, the living run is told of.
  void hear_of_it(std::uint32_t first, std::uint32_t last, Time begin) {
    for (std::uint32_t alive = first; alive <= last; ++alive) {
      directory.life_sign(kRobot, "robot_7", kLiving, alive, 2, begin + (alive - first) * 1s);
    }
  }
  RobotDirectory directory;
};

TEST(RobotDirectory, ARunThatGoesOnIsReinstated) {
  Displaced displaced;
  ASSERT_TRUE(displaced.directory.is_former(kRobot, kLiving));
  displaced.hear_of_it(2, 6, 11s);
  EXPECT_FALSE(displaced.directory.is_former(kRobot, kLiving));
  EXPECT_TRUE(displaced.directory.is_former(kRobot, kEnded));
  EXPECT_EQ(displaced.directory.find(kRobot)->boot, kLiving);
}

TEST(RobotDirectory, AnEndedRunStaysEnded) {
  RobotDirectory directory;
  directory.life_sign(kRobot, "robot_7", kEnded, 30, 2, 10s);
  directory.life_sign(kRobot, "robot_7", kLiving, 1, 1, 11s);
  directory.life_sign(kRobot, "robot_7", kEnded, 31, 3, 11s);
  directory.life_sign(kRobot, "robot_7", kEnded, 31, 3, 16s);  // whose second 31 was told, never 33
  EXPECT_TRUE(directory.is_former(kRobot, kEnded));
  EXPECT_EQ(directory.find(kRobot)->boot, kLiving);
}

TEST(RobotDirectory, WhatLivesIsNotDisplacedWhileItIsHeardOf) {
  Displaced displaced;
  displaced.directory.life_sign(kRobot, "robot_7", kEnded, 31, 3, 11s);
  displaced.directory.life_sign(kRobot, "robot_7", kLiving, 9, 2, 12s);
  EXPECT_EQ(displaced.directory.find(kRobot)->boot, kEnded);
}

TEST(RobotDirectory, OfSeveralRadiosOfANameTheLivingAndNearestCounts) {
  RobotDirectory directory;
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
