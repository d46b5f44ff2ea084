// Local control: of the motions the robot can make next, the one after which the least time is left to the goal.
#pragma once

#include <algorithm>
#include <limits>
#include <mr_grid/cells.hpp>
#include <optional>
#include <vector>

#include "footprint.hpp"
#include "march.hpp"
#include "points.hpp"

namespace mr_robot::navigation {

constexpr double kProgress = 0.1;       // m of motion that count as one; what is less is SLAM's
constexpr double kTouching = 0.03;      // m to obstacles, less than which may be a touch: poses and points are inexact
constexpr double kSlack = 0.002;        // m that a motion may come nearer to what the body touches already
constexpr double kHeadingWeight = 0.7;  // s of turning towards the way after that, counted as this share of driving
constexpr double kSteadiness = 0.02;    // s that a rad/s of change counts
constexpr double kRamp = 0.4;           // s of a motion that have to be clear when it begins

struct Velocity {
  double linear, angular;  // m/s, rad/s
};

struct Obstacle {
  double x, y;           // m, frame of the poses
  double margin;         // m, how far the footprint has to stay away
  double reaction_time;  // s, by which the margin grows with speed: what moves comes nearer meanwhile
};

struct Limits {
  double linear, angular;                            // m/s, rad/s
  double linear_acceleration, angular_acceleration;  // m/s^2, rad/s^2
  double curvature = kUnreached;                     // 1/m of a way ahead; a robot that stands may turn
};

struct Horizon {
  double duration, step = 0.1;  // s
  double goal_radius = 0.1;     // m, a motion that comes this near to the goal is complete
  double slack = 0.0;           // m nearer than now that a robot within touching distance may come
};

// Cost to go on a grid, in cells of time at full speed.
struct Field : mr_grid::Grid<float> {
  Point goal;  // m
};

// Between cells; infinity where there is no way.
double cost_at(const Field& field, double x, double y);

// Direction of steepest descent, rad, over a stencil wide enough to smooth the grid.
std::optional<double> downhill(const Field& field, double x, double y);

struct Choice {
  Velocity velocity;  // to command now
  Velocity target;    // what the motion ramps to
  double time;        // s to the goal by this motion
  double gained;      // s less than where the robot stands, when the motion has ended
  double clearance;   // m, least distance of the footprint from obstacles on the way, less their margins
  bool found;
};

// Least distance of a rectangle from obstacles, m, negative inside.
struct Clearance {
  double bare, with_margins;
};

// m that a motion has to keep, without margins, from obstacles that the body is `at_start` away from. `slack`: m nearer
// that a robot within touching distance may come; as near as it takes from kTouching on.
inline double least_clearance(double at_start, double slack) {
  const double nearest = slack < kTouching ? 0.5 * kTouching : std::numeric_limits<double>::min();
  return std::min({kTouching, at_start, std::max(at_start - slack, nearest)});
}

// `speed`: for which the margins are taken, m/s.
Clearance clearance(const Pose& pose, double speed, const std::vector<Obstacle>& obstacles, const Footprint& footprint);

Choice choose(const Field& field, const Pose& pose, const Velocity& velocity, const std::vector<Obstacle>& obstacles,
              const Limits& limits, const Footprint& footprint, const Horizon& horizon, double period);

// Whether the motion ramping to `target` stays clear of the obstacles for `duration`.
bool is_clear(const Pose& pose, const Velocity& velocity, const Velocity& target,
              const std::vector<Obstacle>& obstacles, const Limits& limits, const Footprint& footprint,
              const Horizon& horizon);

}  // namespace mr_robot::navigation
