// A large team on the move, and between whom a path of good links stood for how long.
#pragma once

#include <cstdint>
#include <vector>

#include "random_waypoint.hpp"
#include "simulation/team.hpp"

namespace adhoc_communication::bench {

/// Robots wander through a square. A frame over d metres is lost with the probability (d / 25 m)^4, so that a
/// link is good (p <= 0.3) up to 18.5 m: on 100 m x 100 m 100 robots have about ten good neighbours each, and about as
/// many bad ones.
class MovingTeam {
 public:
  static constexpr Time kStep = std::chrono::milliseconds(250);  ///< between positions
  static constexpr double kReach = 25.0;                         ///< metres
  static constexpr double kGoodLoss = 0.3;

  /// `contention`: all on one channel; otherwise each has its own to send on.
  /// `side`: m, of the square.
  MovingTeam(std::size_t robots, double side, const EngineOptions& options, std::uint64_t seed, bool contention);

  Team& team() { return team_; }
  /// Lets the robots drive and talk for kStep.
  void step();
  /// Numbers the parts of the team that have been connected by links which were good ever since `begin`: robots with
  /// the same number had one and the same path all that time.
  std::vector<std::size_t> parts_since(Time begin) const;
  double mean_degree() const;  ///< good links of a robot, over all steps

 private:
  static double loss_at(double distance);
  void place_robots();
  void set_link(std::size_t a, std::size_t b, double distance);
  Time& good_since(std::size_t a, std::size_t b) { return good_since_[a * robots_.size() + b]; }

  Team team_;
  std::vector<RandomWaypoint> robots_;
  std::vector<Time> good_since_;  ///< by pair, the smaller number first; Time::max() for a link that is not good now
  std::vector<bool> lossy_;       ///< pairs with a loss of their own
  std::uint64_t good_links_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace adhoc_communication::bench
