// What an adversary does for seconds on end to a team that works, open and sealed. In a sealed team he has the key, or
// plays back what he has recorded. Nobody is deafened, every packet arrives, and every table keeps its bound.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "host.hpp"
#include "insider.hpp"

namespace adhoc_communication {

class AdversarySuite : public testing::TestWithParam<bool> {
 public:
  static constexpr std::size_t kRobots = 3;
  static constexpr Time kStep = std::chrono::milliseconds(10);
  static constexpr int kSteps = 500;

  /// Octets of the largest packet that the robots take.
  static std::size_t largest() { return setting("ADVERSARY_LARGEST_PACKET", 1'000'000); }

 protected:
  using Attack = std::function<void(int step, std::size_t robot)>;

  AdversarySuite() : AdversarySuite(0.0) {}
  /// Robots in a row, `spacing` metres apart.
  explicit AdversarySuite(double spacing) : team_({}, setting("ADVERSARY_SEED", 1)) {
    options_.max_packet_size = largest();
    if (GetParam()) options_.keys = {TeamKey{7}};
    team_.add_line(kRobots, options_, spacing);
    team_.run_for(std::chrono::seconds(3));
    forget();
  }

  static void TearDownTestSuite() { RecordProperty("peak_kilobytes", peak_resident_set()); }

  Insider insider() { return Insider(team_, make_host(5), options_.keys); }
  void forget() {
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      team_.presence(robot).clear();
      team_.received(robot).clear();
    }
  }

  /// The attack goes on for five seconds, at each robot in each step, while each robot sends to the next one. All has
  /// to have arrived `patience` later.
  void withstand(const Attack& attack, Time patience = std::chrono::seconds(3)) {
    std::vector<std::pair<std::size_t, SendId>> sends;
    for (int step = 0; step < kSteps; ++step) {
      for (std::size_t robot = 0; robot < kRobots; ++robot) attack(step, robot);
      if (step % 50 == 0) {
        for (std::size_t robot = 0; robot < kRobots; ++robot) {
          const std::string next = Team::name((robot + 1) % kRobots);
          sends.emplace_back(robot, team_.send(robot, next, noise(step % 100 == 0 ? 3'000 : 60'000)));
        }
      }
      team_.run_for(kStep);
      expect_bounds();
    }
    team_.run_for(patience);
    for (const auto& [robot, id] : sends) expect_delivered(robot, id);
    for (std::size_t robot = 0; robot < kRobots; ++robot) expect_nobody_lost(robot);
  }

  void expect_delivered(std::size_t robot, SendId id) {
    const SendFinished* end = team_.finished(robot, id);
    ASSERT_NE(end, nullptr) << Team::name(robot);
    EXPECT_TRUE(end->delivered) << Team::name(robot) << ": " << end->reason;
  }
  void expect_nobody_lost(std::size_t robot) {
    for (const auto& [at, word] : team_.presence(robot)) {
      EXPECT_NE(word.rfind("-robot_", 0), 0u) << Team::name(robot) << " was told " << word;
    }
  }
  void expect_bounds() {
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      for (const TableFill& table : team_.engine(robot).tables()) ASSERT_LE(table.size, table.most) << table.table;
    }
  }

  EngineOptions options_;
  Team team_;

 private:
  /// What `bench_adversaries` may set.
  static std::uint64_t setting(const char* name, std::uint64_t otherwise) {
    const char* value = std::getenv(name);
    return value == nullptr ? otherwise : std::strtoull(value, nullptr, 10);
  }
  /// Of the process, in kB.
  static int peak_resident_set() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
      if (line.rfind("VmHWM:", 0) == 0) return std::atoi(line.c_str() + 6);
    }
    return 0;
  }
};

}  // namespace adhoc_communication
