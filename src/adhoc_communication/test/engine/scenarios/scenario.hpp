// A team, its radio and everything that happens to them, all from one seed.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "medium/medium.hpp"

namespace adhoc_communication {

struct Action {
  enum class Kind {
    kMove,       ///< robot to x, y
    kLoss,       ///< of all links: x
    kOneWay,     ///< loss x from robot to other
    kPartition,  ///< robots of `side` and the others no longer hear each other
    kRejoin,     ///< all links back to range and common loss
    kCrash,
    kRestart,
    kUnicast,    ///< robot to other
    kGroup,      ///< robot to the group of other
    kBroadcast,  ///< to everybody in range
    kFlood,      ///< over `hops` hops
    kJoin,       ///< robot the group of other
    kLeave,
    kSetKeys,  ///< of robot
    kReplay,   ///< frames recorded on the air are sent once more by a stranger
  };

  Time at{0};
  Kind kind = Kind::kMove;
  std::size_t robot = 0;
  std::size_t other = 0;
  double x = 0.0;
  double y = 0.0;
  std::vector<bool> side;
  std::size_t size = 0;
  Priority priority = Priority::kNormal;
  std::uint8_t hops = 1;
  std::vector<TeamKey> keys;
};

/// One line for people.
std::string describe(const Action& action);

struct Scenario {
  std::uint64_t seed = 0;
  std::string topology;
  EngineOptions options;
  MediumOptions medium;
  std::vector<std::pair<double, double>> places;  ///< of the robots at the start
  std::vector<Action> actions;                    ///< in order of time
  Time end{0};                                    ///< of what happens; afterwards the radio is good and all robots run
};

/// One line for people.
std::string describe(const Scenario& scenario);

/// `contended`: on one channel that robots contend for, whatever the seed says; all else is as without.
Scenario make_scenario(std::uint64_t seed, bool contended = false);

}  // namespace adhoc_communication
