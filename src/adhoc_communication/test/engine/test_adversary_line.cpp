// What an adversary does to robots in a line, who know each other by hearsay: in a sealed team he has the key, in an
// open one he only names the run of the robot that he talks to.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "host.hpp"
#include "insider.hpp"
#include "routing/robot_directory.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kForgedSign = 0x40000000;

class AdversaryInALine : public testing::TestWithParam<bool> {
 protected:
  static constexpr std::size_t kRobots = 4;
  static constexpr double kSpacing = 8.0;

  AdversaryInALine() {
    if (GetParam()) options_.keys = {TeamKey{7}};
    team_.add_line(kRobots, options_, kSpacing);
    team_.run_for(5s);
    forget();
  }

  Insider insider() { return Insider(team_, make_host(50), options_.keys); }
  void forget() {
    for (std::size_t robot = 0; robot < team_.size(); ++robot) team_.presence(robot).clear();
  }
  bool knows(std::size_t robot, std::size_t other) {
    const std::vector<std::string> robots = team_.engine(robot).robots();
    return std::find(robots.begin(), robots.end(), Team::name(other)) != robots.end();
  }
  void expect_nobody_lost() {
    for (std::size_t robot = 0; robot < team_.size(); ++robot) {
      for (const auto& [at, word] : team_.presence(robot)) {
        EXPECT_NE(word.rfind("-robot_", 0), 0u) << Team::name(robot) << " was told " << word;
      }
    }
  }
  /// So many robots that do not exist, as many as go into 26 frames or into one.
  void tell_of_strangers(Insider& liar, std::size_t robot, std::size_t frames = 26) {
    for (std::size_t frame = 0; frame < frames; ++frame) {
      std::vector<wire::Rumor> rumors;
      for (std::size_t i = 0; i < 40; ++i) {
        const Host host = make_host(1000 + next_stranger_++);
        rumors.push_back({host.address, host.boot(), 1, 34, "x" + std::to_string(next_stranger_)});
      }
      liar.prove(robot, rumors);
    }
  }

  EngineOptions options_;
  Team team_;
  std::size_t next_stranger_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Open, AdversaryInALine, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Sealed, AdversaryInALine, testing::Values(true));

/// One beacon made all true signs old, and the robot was lost two and three hops away, for as long as it was repeated.
TEST_P(AdversaryInALine, AForgedLifeSignLosesNobody) {
  Insider liar = insider();
  const Host victim = liar.robot(3);
  for (int round = 0; round < 6; ++round) {
    for (std::size_t robot = round % 2 == 0 ? 2 : 0; robot < 3; ++robot) {
      liar.prove(robot);
      liar.prove(robot, {{victim.address, victim.boot(), kForgedSign + 1000 * static_cast<std::uint32_t>(round), 1,
                          victim.name}});
    }
    team_.run_for(round < 3 ? 10s : 3s);
    expect_nobody_lost();
  }
  const SendId id = team_.send(0, "robot_3", text("still there"));
  ASSERT_TRUE(team_.run_until_done([&] { return team_.finished(0, id) != nullptr; }, 5s));
  EXPECT_TRUE(team_.finished(0, id)->delivered);
}

/// He is the first to tell of a run.
TEST_P(AdversaryInALine, AForgedFirstLifeSignLosesNobodyForLong) {
  Insider liar = insider();
  for (std::size_t robot = 0; robot < 3; ++robot) liar.prove(robot);
  team_.restart(3);
  const Host victim = liar.robot(3);
  for (std::size_t robot = 0; robot < 3; ++robot) {
    liar.prove(robot, {{victim.address, victim.boot(), kForgedSign, 1, victim.name}});
  }
  team_.run_for(20s);
  forget();
  for (std::size_t robot = 0; robot < 3; ++robot) EXPECT_TRUE(knows(robot, 3)) << Team::name(robot);
  team_.run_for(20s);
  expect_nobody_lost();
}

/// A burst of them kept a new robot unknown for a minute, also to those that heard it.
TEST_P(AdversaryInALine, StrangersToldOfKeepNoNewcomerOut) {
  Insider liar = insider();
  liar.prove(0);
  liar.prove(2);
  team_.run_for(100ms);
  tell_of_strangers(liar, 0);
  tell_of_strangers(liar, 2);
  team_.run_for(500ms);
  for (std::size_t robot = 0; robot < kRobots; ++robot) {
    EXPECT_LT(team_.engine(robot).robots().size(), 3 * routing::RobotDirectory::kMostOfATeller) << Team::name(robot);
  }
  team_.add(options_, 0.0, kSpacing);
  team_.run_for(2s);
  EXPECT_TRUE(knows(0, kRobots)) << "it is heard";
  tell_of_strangers(liar, 0, 1);
  team_.run_for(98s);  // those told of three hops away are remembered for longest
  for (std::size_t robot = 0; robot < kRobots; ++robot) EXPECT_TRUE(knows(robot, kRobots)) << Team::name(robot);
  expect_nobody_lost();
}

/// Packets of sources that nobody knows began searches, until there was no room for those for own packets.
TEST_P(AdversaryInALine, UnknownSourcesHoldUpNoSearch) {
  Insider liar = insider();
  std::vector<SendId> sends;
  std::size_t stranger = 0;
  for (int step = 0; step < 1000; ++step) {
    if (step % 25 == 0) liar.prove(0);
    liar.say(0, data_for(liar.robot(0), make_host(2000 + stranger++), 1));
    if (step % 100 == 50) team_.restart(2);  // a route has to be found
    if (step % 100 == 80) sends.push_back(team_.send(0, "robot_2", text("x")));
    team_.run_for(10ms);
    for (const TableFill& table : team_.engine(0).tables()) ASSERT_LE(table.size, table.most) << table.table;
  }
  team_.run_for(3s);
  for (const SendId id : sends) {
    ASSERT_NE(team_.finished(0, id), nullptr);
    EXPECT_TRUE(team_.finished(0, id)->delivered) << team_.finished(0, id)->reason;
  }
}

/// What one neighbour said of the spacing of frames slowed down what went to others.
TEST_P(AdversaryInALine, WhatANeighborSaysOfTheAirSilencesNobody) {
  Insider liar = insider();
  std::vector<std::uint64_t> counters;
  team_.on_transmission = [&](std::size_t robot, const Frame& frame) {
    wire::Reader reader(frame.bytes);
    const auto header = wire::read_header(reader);
    if (robot == 0 && header && header->next_hop == liar.host().address) counters.push_back(header->counter);
  };
  liar.prove(0);
  team_.run_for(100ms);
  std::vector<SendId> sends;
  for (int step = 0; step < 200; ++step) {
    if (step % 7 == 0) liar.prove(0);
    liar.demand_acknowledgment(0);
    for (const std::uint64_t counter : counters) {
      wire::HopAcknowledgment acknowledgment;
      acknowledgment.boot = wire::boot_tag(team_.boot_id(0));
      acknowledgment.newest_counter = counter;
      acknowledgment.spacing_ns = 0xffffffff;
      liar.say(0, acknowledgment);
    }
    counters.clear();
    if (step % 20 == 0) sends.push_back(team_.send(0, "robot_1", noise(20'000)));
    team_.run_for(30ms);
    if (step % 20 != 19) continue;
    ASSERT_NE(team_.finished(0, sends.back()), nullptr) << "in more than half a second";
    EXPECT_TRUE(team_.finished(0, sends.back())->delivered);
  }
}

}  // namespace
}  // namespace adhoc_communication
