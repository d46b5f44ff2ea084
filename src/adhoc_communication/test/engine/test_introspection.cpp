// What hosts see of links, queues, groups and names.
#include <gtest/gtest.h>

#include "payloads.hpp"
#include "simulation/team.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

TEST(Introspection, LinksTellNameDirectionAndSilence) {
  Team team;
  team.add_line(3);
  team.run_for(2s);
  const auto links = team.engine(1).links();
  ASSERT_EQ(links.size(), 2u);
  EXPECT_EQ(links[0].name, "robot_0");
  EXPECT_EQ(links[0].address, Team::address(0));
  EXPECT_TRUE(links[0].two_way);
  EXPECT_LE(links[0].silent_for, 300ms);
  EXPECT_EQ(team.engine(0).links().size(), 1u);
  team.kill(0);
  team.run_for(3s);
  const auto later = team.engine(1).links();
  ASSERT_EQ(later.size(), 2u);
  EXPECT_FALSE(later[0].two_way);
  EXPECT_GE(later[0].silent_for, 2s);
}

TEST(Introspection, LossOfALinkIsThatOfTheMedium) {
  MediumOptions medium;
  medium.loss = 0.3;
  Team team(medium, 5);
  team.add_line(2);
  team.run_for(1s);
  team.send(0, "robot_1", noise(400'000));
  team.run_for(2s);
  const auto links = team.engine(0).links();
  ASSERT_EQ(links.size(), 1u);
  EXPECT_NEAR(links[0].loss, 0.3, 0.25);
  EXPECT_GT(links[0].loss, 0.05);
}

TEST(Introspection, QueuesCountWhatIsNotFinished) {
  Team team;
  team.add_line(2);
  team.run_for(1s);
  EXPECT_EQ(team.engine(0).queues().packets, 0u);
  const SendId first = team.send(0, "robot_1", noise(100'000));
  const SendId second = team.send(0, "robot_1", noise(100'000, 2));
  EXPECT_EQ(team.engine(0).queues().packets, 2u);
  EXPECT_GE(team.engine(0).queues().octets, 200'000u);
  ASSERT_TRUE(team.run_until_done(
      [&] { return team.finished(0, first) != nullptr && team.finished(0, second) != nullptr; }, 10s));
  EXPECT_EQ(team.engine(0).queues().packets, 0u);
  EXPECT_EQ(team.engine(0).queues().octets, 0u);
}

TEST(Introspection, GroupsAndNames) {
  Team team;
  team.add_line(3);
  team.run_for(5s);
  EXPECT_EQ(team.engine(0).groups(), (std::vector<std::string>{"mc_robot_0", "mc_robot_1", "mc_robot_2"}));
  EXPECT_EQ(team.engine(0).name_of(Team::address(0)), "robot_0");
  EXPECT_EQ(team.engine(0).name_of(Team::address(2)), "robot_2");
  EXPECT_FALSE(team.engine(0).name_of(Team::address(9)));
}

TEST(Introspection, WhoIsJoiningIsNoMemberYet) {
  Team team;
  EngineOptions options;
  options.join_groups_automatically = false;
  team.add_line(2, options);
  team.run_for(1s);
  team.engine(0).join_group("mc_robot_1", team.now());
  EXPECT_TRUE(team.engine(0).group_state("mc_robot_1").known);
  EXPECT_TRUE(team.engine(0).group_state("mc_robot_1").joining);
  EXPECT_FALSE(team.engine(0).group_state("mc_robot_1").member);
  team.run_for(2s);
  EXPECT_FALSE(team.engine(0).group_state("mc_robot_1").joining);
  EXPECT_TRUE(team.engine(0).group_state("mc_robot_1").member);
}

}  // namespace
}  // namespace adhoc_communication
