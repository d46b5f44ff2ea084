// The manoeuvres of navigation, planned by OMPL.
#pragma once

#include <vector>

#include "manoeuvre.hpp"

namespace navigation_peers {

struct OmplSettings {
  double radius = 0.1;  // m of Reeds and Shepp's ways
  double limit = 0.05;  // s of processor time of a plan
};

// As `mr_robot::navigation::manoeuvre`: the same poses may be passed and be the end, and what counts is the same time.
// RRT-Connect leads to some of the ends that were drawn in a fifth of the time, again and again until the time is over,
// on Reeds and Shepp's ways and, in turns with them, on straight ones between turns on the spot. Of the ways,
// shortened, the best is taken.
std::vector<mr_robot::navigation::Waypoint> ompl_manoeuvre(const mr_robot::navigation::Field& field,
                                                           const mr_robot::navigation::Pose& start,
                                                           const std::vector<mr_robot::navigation::Obstacle>& obstacles,
                                                           const mr_robot::navigation::Footprint& footprint,
                                                           const mr_robot::navigation::Agility& agility,
                                                           const OmplSettings& settings);

}  // namespace navigation_peers
