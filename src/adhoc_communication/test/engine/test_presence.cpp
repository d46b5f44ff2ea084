// Robots appear, fall silent, restart; near and far.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> words(const std::vector<std::pair<Time, std::string>>& presence) {
  std::vector<std::string> result;
  for (const auto& item : presence) result.push_back(item.second);
  return result;
}

/// After five seconds of silence, which is looked at before each beacon of one's own.
TEST(Presence, NeighborAppearsAtOnceAndIsLostAfterFiveSeconds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Team team({}, seed);
    team.add_line(2);
    team.run_for(100ms);
    EXPECT_EQ(words(team.presence(0)), std::vector<std::string>{"+robot_1"}) << seed;
    EXPECT_EQ(team.engine(0).neighbors(), std::vector<std::string>{"robot_1"}) << seed;
    const Time killed = team.now();
    team.kill(1);
    team.run_for(7s);
    ASSERT_EQ(words(team.presence(0)), (std::vector<std::string>{"+robot_1", "-robot_1"})) << seed;
    EXPECT_GT(team.presence(0).back().first - killed, 4900ms) << seed;
    EXPECT_LT(team.presence(0).back().first - killed, 6050ms) << seed;
    EXPECT_TRUE(team.engine(0).neighbors().empty()) << seed;
  }
}

TEST(Presence, RestartIsRecognisedSoon) {
  Team team;
  team.add_line(2);
  team.run_for(1s);
  const Time restarted = team.now();
  team.restart(1);
  team.run_for(500ms);
  EXPECT_EQ(words(team.presence(0)), (std::vector<std::string>{"+robot_1", "-robot_1", "+robot_1"}));
  EXPECT_LE(team.presence(0).back().first - restarted, 350ms);
}

TEST(Presence, LinkThatComesBackCarriesARouteAtOnce) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Team team({}, seed);
    team.add_line(2);
    team.run_for(500ms + seed * 20ms);
    team.medium().set_link_loss(0, 1, 1.0);
    const SendId lost = team.send(1, "robot_0", Bytes(10));
    team.run_until_done([&] { return team.finished(1, lost) != nullptr; }, 8s);
    EXPECT_FALSE(team.finished(1, lost)->delivered);
    team.medium().set_link_loss(0, 1, std::nullopt);
    const SendId sent = team.send(1, "robot_0", Bytes(10));
    team.run_until_done([&] { return team.finished(1, sent) != nullptr; }, 400ms);
    ASSERT_NE(team.finished(1, sent), nullptr) << "seed " << seed;
    EXPECT_TRUE(team.finished(1, sent)->delivered) << "seed " << seed;
  }
}

TEST(Presence, FarRobotsAreKnownAndNeverFlicker) {
  MediumOptions medium;
  medium.loss = 0.1;
  Team team(medium, 3);
  team.add_line(6);
  team.run_for(60s);
  for (std::size_t robot = 0; robot < 6; ++robot) {
    EXPECT_EQ(team.engine(robot).robots().size(), 5u);
    EXPECT_EQ(team.presence(robot).size(), 5u) << "robot_" << robot;
  }
  EXPECT_EQ(team.engine(0).neighbors(), std::vector<std::string>{"robot_1"});
}

TEST(Presence, DeadFarRobotIsForgottenByAllInBoundedTime) {
  Team team;
  team.add_line(6);
  team.run_for(10s);
  team.kill(5);
  team.run_for(16s);
  for (std::size_t robot = 0; robot < 5; ++robot) {
    EXPECT_EQ(team.presence(robot).back().second, "-robot_5") << "robot_" << robot;
    EXPECT_EQ(team.engine(robot).robots().size(), 4u);
  }
}

TEST(Presence, A8_2_A13_4_AnIdleTeamSendsBeaconsOnlyAndFewOfThem) {
  Team team;
  for (int i = 0; i < 3; ++i) team.add();
  team.run_for(10s);
  const std::uint64_t polls = team.polls();
  std::size_t frames = 0;
  team.on_transmission = [&](std::size_t, const Frame& frame) {
    EXPECT_EQ(frame.bytes[1], static_cast<std::uint8_t>(wire::FrameType::kBeacon));
    ++frames;
  };
  team.run_for(60s);
  EXPECT_LE(frames, 3 * 64u) << "one a second";
  EXPECT_LE(static_cast<double>(team.polls() - polls) / 60 / 3, 14.0);  // own beacons and those heard
}

/// Beacons to a silent neighbour by itself until 4.5 s after the last one of it; `told`: another one tells of it.
std::size_t questions_to_a_silent_neighbor(bool told) {
  Stage stage;
  Host& teller = stage.neighbor(1);
  Host& silent = stage.neighbor(2, false);
  silent.announced_interval_ms = 1000;
  stage.beacon(silent);
  silent.acknowledges = false;
  stage.forget();
  for (std::uint32_t second = 1; second <= 4; ++second) {
    if (told) {
      wire::Beacon beacon;
      beacon.alive = 100 + second;
      beacon.number = ++teller.beacons_said;
      beacon.name = teller.name;
      beacon.rumors.push_back({silent.address, silent.boot(), 100 + second, 1, silent.name});
      stage.say(teller, beacon);
    }
    stage.run_for(1125ms);
  }
  const auto beacons = stage.sent<wire::Beacon>();
  return static_cast<std::size_t>(
      std::count_if(beacons.begin(), beacons.end(), [&](const auto& beacon) { return beacon.to == silent.address; }));
}

/// A hundred robots on the move sent a twentieth of all their frames to neighbours that had driven away.
TEST(Presence, ASilentNeighborIsAskedOnlyIfNobodyTellsOfIt) {
  EXPECT_GT(questions_to_a_silent_neighbor(false), 0u);
  EXPECT_EQ(questions_to_a_silent_neighbor(true), 0u);
}

TEST(Presence, SameSeedSameFrames) {
  const auto trace = [](std::uint64_t seed) {
    MediumOptions medium;
    medium.loss = 0.2;
    Team team(medium, seed);
    team.add_line(4);
    team.run_for(1s);
    team.send(0, "robot_3", noise(50'000));
    team.run_for(2s);
    return team.trace_hash();
  };
  EXPECT_EQ(trace(4), trace(4));
  EXPECT_NE(trace(4), trace(5));
}

}  // namespace
}  // namespace adhoc_communication
