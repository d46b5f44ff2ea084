// Motions where a body has little room: a search over x, y and heading with the footprint.
#pragma once

#include <algorithm>
#include <vector>

#include "map.hpp"
#include "rollout.hpp"

namespace mr_robot::navigation {

struct Waypoint {
  double x, y, yaw;  // m, rad
  double direction;  // of the motion that leads there: 1 ahead, -1 back, 0 on the spot
  double seconds;    // from the start on
};

// How a robot drives in a manoeuvre.
struct Agility {
  explicit Agility(const Limits& limits)
      : limits(limits), linear(std::min(0.25, limits.linear)), angular(std::min(0.8, limits.angular)) {}
  Limits limits;   // where there is room again
  double linear;   // m/s, ahead and back
  double angular;  // rad/s
};

// The way that leads soonest to the goal of the field, up to where the robot has room to turn or where what is known
// around it ends (Dolgov, Thrun, Montemerlo and Diebel, Path planning for autonomous vehicles in unknown
// semi-structured environments, 2010). Ahead and back are the same but for the turns between them; it turns only where
// the footprint does, comes no nearer to obstacles than kTouching, and from nearer by `slack` m nearer. Where no such
// way is found, one to the roomiest pose. Empty if there is no better pose than the present one. Backing over what is
// unknown in the map is the last choice: a laser that looks ahead does not show what is there. Its first motion
// is one that `is_clear` allows a robot that stands. `known`: m around the start in which all obstacles are given.
std::vector<Waypoint> manoeuvre(const Field& field, const Map& map, const Pose& start,
                                const std::vector<Obstacle>& obstacles, const Footprint& footprint,
                                const Agility& agility, double known, double slack);

bool has_room_to_turn(const Pose& pose, const std::vector<Obstacle>& obstacles, const Footprint& footprint);

}  // namespace mr_robot::navigation
