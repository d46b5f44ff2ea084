// How a body that drives ahead and back and turns on the spot gets from one pose to another where nothing is in the
// way.
#pragma once

#include <functional>
#include <vector>

#include "rollout.hpp"

namespace navigation_peers {

using mr_robot::navigation::Pose;

struct Arc {
  double way;   // m, negative: back
  double turn;  // rad on the way
};

using Steering = std::function<std::vector<Arc>(const Pose&, const Pose&)>;

// Turns, drives straight ahead or back, whichever takes less turning, and turns again.
std::vector<Arc> turn_drive_turn(const Pose& from, const Pose& to);

// The shortest of Reeds and Shepp's ways with this radius, m.
Steering reeds_shepp(double radius);

// Where an arc leads.
Pose along(const Pose& pose, const Arc& arc);

// The part of an arc.
Arc part(const Arc& arc, double share);

}  // namespace navigation_peers
