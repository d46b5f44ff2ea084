// A new run on an interface that has changed, and robots that have the same name.
#include <gtest/gtest.h>

#include "host.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr MacAddress kNew = {0x02, 0, 0, 0, 9, 9};
constexpr BootId kNewRun = {9, 9, 9};

std::vector<Event> events_of(Engine& engine) {
  std::vector<Event> events;
  while (auto event = engine.next_event()) events.push_back(std::move(*event));
  return events;
}

TEST(Restart, OthersHearANewRunAtTheNewAddress) {
  Stage stage;
  stage.neighbor(1);
  stage.run_for(1s);
  stage.node().restart(kNew, 600, kNewRun, 1, stage.now());
  stage.forget();
  stage.run_for(1s);
  ASSERT_GT(stage.count(wire::FrameType::kBeacon), 0u);
  for (const auto& [at, frame] : stage.frames()) {
    wire::Reader reader(frame.bytes);
    const wire::FrameHeader header = wire::read_header(reader).value();
    EXPECT_EQ(frame.source, kNew);
    EXPECT_EQ(header.sender, kNew);
    EXPECT_EQ(header.boot_id, kNewRun);
  }
  const SendId large = stage.node().broadcast({"topic", 'A', noise(700), 1}, stage.now());
  stage.run_for(100ms);
  EXPECT_FALSE(stage.team.finished(0, large)->delivered) << "frames follow the MTU";
}

TEST(Restart, WhatIsUnderWayEndsAndRobotsAreLost) {
  Stage stage;
  stage.neighbor(1);
  stage.run_for(1s);
  const SendId open = stage.team.send(0, "host_1", text("x"));
  stage.node().join_group("mc_host_1", stage.now());
  const SendId flood = stage.node().broadcast({"topic", 'A', text("x"), 1}, stage.now());
  stage.node().restart(kNew, 1500, kNewRun, 1, stage.now());
  std::set<SendId> failed;
  int lost = 0;
  int joins = 0;
  for (const Event& event : events_of(stage.node())) {
    if (const auto* end = std::get_if<SendFinished>(&event)) {
      failed.insert(end->id);
      EXPECT_EQ(end->reason, "the interface has changed");
    }
    if (std::holds_alternative<RobotLost>(event)) ++lost;
    if (const auto* end = std::get_if<GroupChangeFinished>(&event)) {
      ++joins;
      EXPECT_FALSE(end->succeeded);
    }
  }
  EXPECT_EQ(failed, (std::set<SendId>{open, flood}));
  EXPECT_EQ(lost, 1);
  EXPECT_EQ(joins, 1);
  EXPECT_GT(stage.team.send(0, "host_1", text("x")), flood) << "numbers of sends are not used twice";
}

TEST(Restart, GroupsAndKeysAreKept) {
  EngineOptions options = without_groups();
  options.keys = {TeamKey{7}};
  Team team;
  team.add_line(2, options);
  team.run_for(2s);
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  ASSERT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
  team.engine(1).restart(Team::address(1), 1000, kNewRun, 1, team.now());
  team.run_for(5s);
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
  const SendId id = team.send(1, "robot_0", noise(20'000));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(1, id) != nullptr; }, 5s));
  EXPECT_TRUE(team.finished(1, id)->delivered) << team.finished(1, id)->reason;
}

TEST(Restart, FramesThatCannotBeUsedLeaveItAsItWas) {
  Stage stage;
  stage.neighbor(1);
  stage.run_for(1s);
  EXPECT_THROW(stage.node().restart(kNew, 100, kNewRun, 1, stage.now()), std::invalid_argument);
  EXPECT_EQ(stage.node().neighbors(), std::vector<std::string>{"host_1"});
}

bool told(Team& team, std::size_t robot, const std::string& word) {
  const auto& words = team.presence(robot);
  return std::any_of(words.begin(), words.end(), [&](const auto& item) { return item.second == word; });
}

TEST(TwoOfAName, AreReportedOnceWhereverTheyAreHeard) {
  Team team;
  for (const char* name : {"alice", "bob", "bob"}) {
    EngineOptions options = without_groups();
    options.robot_name = name;
    team.add(options);
  }
  team.run_for(30s);
  for (std::size_t robot = 0; robot < 3; ++robot) {
    const auto& words = team.presence(robot);
    EXPECT_EQ(std::count_if(words.begin(), words.end(), [](const auto& item) { return item.second == "=bob"; }), 1)
        << robot;
  }
}

TEST(TwoOfAName, ARobotThatGetsAnotherRadioIsNone) {
  Team team;
  team.add_line(3, without_groups());
  team.run_for(5s);
  team.engine(2).restart(kNew, 1500, kNewRun, 1, team.now());
  team.run_for(30s);
  for (std::size_t robot = 0; robot < 3; ++robot) EXPECT_FALSE(told(team, robot, "=robot_2")) << robot;
}

/// When its former address had been silent for long enough it was told to be lost for good, and its group sent latched
/// messages a second time once it was noticed again.
TEST(TwoOfAName, ARobotThatGetsAnotherRadioIsLostOnceAndComesBack) {
  Team team;
  team.add_line(2, without_groups());
  team.run_for(2s);
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  team.engine(1).restart(kNew, 1500, kNewRun, 1, team.now());
  team.run_for(30s);
  std::vector<std::string> words;
  for (const auto& [at, word] : team.presence(0)) words.push_back(word);
  EXPECT_EQ(words, (std::vector<std::string>{"+robot_1", "-robot_1", "+robot_1"}));
  EXPECT_EQ(team.engine(0).robots(), std::vector<std::string>{"robot_1"});
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
}

}  // namespace
}  // namespace adhoc_communication
