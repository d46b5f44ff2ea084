// Sealed frames: what an attacker on the air can see, and what he can change.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "security/frame_guard.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using security::ReplayWindow;

TeamKey key(std::uint8_t fill) {
  TeamKey key;
  key.fill(fill);
  return key;
}

EngineOptions with_keys(std::vector<TeamKey> keys) {
  EngineOptions options;
  options.keys = std::move(keys);
  return options;
}

bool contains(const Bytes& frame, const std::string& words) {
  return std::search(frame.begin(), frame.end(), words.begin(), words.end()) != frame.end();
}

/// Everything a robot put on the air.
std::vector<Frame> record(Team& team, std::size_t robot) {
  std::vector<Frame> frames;
  team.on_transmission = [&](std::size_t sender, const Frame& frame) {
    if (sender == robot) frames.push_back(frame);
  };
  team.run_for(3s);
  team.on_transmission = nullptr;
  return frames;
}

TEST(ReplayWindow, TakesEachCounterOnceInAnyOrder) {
  ReplayWindow window;
  for (const std::uint64_t counter : {5u, 3u, 4u, 1000u, 999u, 2000u}) {
    EXPECT_FALSE(window.seen(counter)) << counter;
    window.take(counter);
    EXPECT_TRUE(window.seen(counter)) << counter;
  }
  EXPECT_TRUE(window.seen(0));
}

TEST(ReplayWindow, BelievesOnlyTheLast1024) {
  ReplayWindow window;
  window.take(5000);
  EXPECT_FALSE(window.seen(5000 - 1023));
  EXPECT_TRUE(window.seen(5000 - 1024));
  window.take(5001);
  EXPECT_TRUE(window.seen(5001 - 1024));
  EXPECT_TRUE(window.seen(5000));
  EXPECT_FALSE(window.seen(4999));
}

TEST(ReplayWindow, ForgetsWhatLiesInAPassedOverStretch) {
  ReplayWindow window;
  window.take(10);
  window.take(10 + 1024);  // the same place in memory
  EXPECT_FALSE(window.seen(11));
  EXPECT_TRUE(window.seen(10));
}

TEST(Security, SealedRobotsUnderstandEachOtherOverSeveralHops) {
  Team team;
  team.add_line(4, with_keys({key(1)}));
  bool readable = false;
  team.on_transmission = [&](std::size_t, const Frame& frame) {
    readable |= contains(frame.bytes, "meeting point") || contains(frame.bytes, "robot_");
  };
  team.run_for(3s);
  const SendId id = team.send(0, "robot_3", text("meeting point"));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 5s));
  EXPECT_TRUE(team.finished(0, id)->delivered);
  EXPECT_EQ(text(team.received(3).at(0).packet.payload), "meeting point");
  EXPECT_FALSE(readable) << "names and payloads are visible on the air";
}

TEST(Security, AnotherKeyIsAnotherTeam) {
  Team team;
  team.add(with_keys({key(1)}));
  team.add(with_keys({key(2)}));
  team.add();
  team.run_for(3s);
  for (std::size_t robot = 0; robot < 3; ++robot) EXPECT_TRUE(team.engine(robot).robots().empty()) << robot;
  EXPECT_GT(team.engine(0).statistics().frames_dropped.forged, 0u);
  EXPECT_GT(team.engine(0).statistics().frames_dropped.unsealed, 0u);
  EXPECT_GT(team.engine(2).statistics().frames_dropped.no_key, 0u);
}

/// Forged, truncated, reflected and repeated frames leave no trace in what the robots do.
TEST(Security, A13_5_HostileFramesChangeNothing) {
  std::vector<std::uint64_t> hashes;
  for (const bool attacked : {false, true}) {
    Team team({}, 7);
    team.add(with_keys({key(1)}));
    team.add(with_keys({key(1)}));
    Random random(3);
    std::vector<Frame> heard;
    std::uint64_t hostile = 0;
    team.on_transmission = [&](std::size_t, const Frame& frame) { heard.push_back(frame); };
    for (int step = 0; step < 300; ++step) {
      if (step == 100) team.send(0, "robot_1", noise(20'000));
      const std::size_t arrived = heard.size();
      team.run_for(10ms);
      if (!attacked || arrived == 0) continue;
      const Frame frame = heard[random.next() % arrived];
      for (std::size_t kind = 0; kind < 4; ++kind) {
        Frame forged = frame;
        if (kind == 0) forged.bytes[random.next() % forged.bytes.size()] ^= 0x10;
        if (kind == 1) forged.bytes.resize(random.next() % forged.bytes.size());
        if (kind == 2) forged.source = Team::address(1);  // a frame of robot 0 said to be of robot 1
        for (std::size_t robot = 0; robot < 2; ++robot) {
          team.engine(robot).receive(forged, team.now());
          ++hostile;
        }
      }
    }
    hashes.push_back(team.trace_hash());
    if (!attacked) continue;
    EXPECT_GT(hostile, 2000u);
    for (std::size_t robot = 0; robot < 2; ++robot) {
      const FramesDropped& dropped = team.engine(robot).statistics().frames_dropped;
      EXPECT_GT(dropped.forged, 0u);
      EXPECT_GT(dropped.malformed, 0u);
      EXPECT_GT(dropped.replayed, 0u);
      EXPECT_GT(dropped.reflected, 0u);
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(Security, A13_5_OpenRepliesAndErrorsChangeNothing) {
  Stage stage(with_keys({key(1)}));
  Host forger = make_host(1);
  stage.beacon(forger);
  stage.give_route(forger, make_host(2));
  stage.say(forger, error_about({{make_host(2), 9}}));
  stage.run_for(10ms);
  EXPECT_TRUE(stage.node().routes().empty());
  EXPECT_EQ(stage.count(wire::FrameType::kRouteError), 0u);
  EXPECT_EQ(stage.node().statistics().frames_dropped.unsealed, 3u);
}

TEST(Security, FramesRecordedBeforeARestartProveNothing) {
  Team team;
  team.add(with_keys({key(1)}));
  team.add(with_keys({key(1)}));
  const std::vector<Frame> recorded = record(team, 1);
  ASSERT_GT(recorded.size(), 5u);
  team.kill(1);
  team.restart(0);
  team.presence(0).clear();
  team.run_for(1s);
  for (const Frame& frame : recorded) {
    team.engine(0).receive(frame, team.now());
    team.run_for(20ms);
  }
  EXPECT_TRUE(team.presence(0).empty());
  EXPECT_TRUE(team.engine(0).routes().empty());
  EXPECT_EQ(team.engine(0).statistics().frames_dropped.unproven, recorded.size());
}

TEST(Security, ARestartedRobotIsBelievedAtOnce) {
  Team team;
  team.add(with_keys({key(1)}));
  team.add(with_keys({key(1)}));
  team.run_for(3s);
  team.kill(1);
  team.restart(1);
  const SendId id = team.send(1, "robot_0", text("back"));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(1, id) != nullptr; }, 1s));
  EXPECT_TRUE(team.finished(1, id)->delivered);
}

TEST(Security, TheKeyChangesWhileFramesFlow) {
  MediumOptions lossy;
  lossy.loss = 0.1;
  Team team(lossy);
  team.add_line(3, with_keys({key(1)}));
  team.run_for(3s);
  std::vector<SendId> ids;
  const auto flow = [&] {
    for (int i = 0; i < 30; ++i) {
      ids.push_back(team.send(0, "robot_2", noise(2000)));
      team.run_for(20ms);
    }
  };
  const std::vector<std::vector<TeamKey>> steps{{key(1), key(2)}, {key(2), key(1)}, {key(2)}};
  for (const auto& keys : steps) {
    for (std::size_t robot = 0; robot < 3; ++robot) {
      team.engine(robot).set_keys(keys);
      flow();  // robots change one after another
    }
  }
  team.run_for(5s);
  for (const SendId id : ids) EXPECT_TRUE(team.finished(0, id) && team.finished(0, id)->delivered);
  for (std::size_t robot = 0; robot < 3; ++robot) {
    EXPECT_EQ(team.engine(robot).statistics().frames_dropped.forged, 0u) << robot;
    for (const auto& [at, what] : team.presence(robot)) EXPECT_LT(at, 3s) << what;
  }
}

TEST(Security, SealingIsNotTurnedOnOrOffInMidFlight) {
  Team team;
  team.add(with_keys({key(1)}));
  team.add();
  EXPECT_THROW(team.engine(0).set_keys({}), std::invalid_argument);
  EXPECT_THROW(team.engine(1).set_keys({key(1)}), std::invalid_argument);
}

TEST(Security, RunsKnownAreBounded) {
  FramesDropped dropped;
  const Identity self{"robot_0", Team::address(0), {}, 0};
  security::FrameGuard guard(self, {key(1)}, dropped);
  for (std::uint32_t run = 0; run < 5000; ++run) {
    Identity other{"robot_1", Team::address(1), {}, 0};
    for (std::size_t i = 0; i < 4; ++i) other.boot_id[i] = static_cast<std::uint8_t>(run >> 8 * i);
    security::FrameGuard sender(other, {key(1)}, dropped);
    wire::FrameHeader header;
    header.sender = other.address;
    header.boot_id = other.boot_id;
    header.counter = 1;
    header.next_hop = wire::kEverybody;
    const Frame frame{wire::kEverybody, other.address, sender.close(header, text("x"))};
    EXPECT_TRUE(guard.open(frame, Time(run)));
    if (run == 0) guard.prove(header);
  }
  EXPECT_EQ(guard.sessions(), security::FrameGuard::kMostSessions);
  wire::FrameHeader first;
  first.sender = Team::address(1);
  EXPECT_TRUE(guard.proven(first)) << "proven runs are forgotten last";
}

}  // namespace
}  // namespace adhoc_communication
