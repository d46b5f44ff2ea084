// Surfaces near the robot, as the hits of a scan show them.
#pragma once

#include <vector>

#include "rollout.hpp"
#include "scan.hpp"

namespace mr_robot::navigation {

// Close to the robot hits lie denser than they are exact: the mean of many beams says where a surface is, while the
// nearest of them seems to touch a robot that stands beside it.
std::vector<Point> smoothed(const ScanView& scan, double reach);

// A point where the laser is blind, and the last one that it sees of the same surface. Robot's frame.
struct Beyond {
  Point point, edge;
};

// What is close beside the robot at an edge of the field of view goes on where the laser is blind: beside a wall a
// robot that turns touches it with a corner that it does not see. For the length of the robot, but not where that would
// lead into it. `surface`: m of it that tell its direction.
std::vector<Beyond> continued(const ScanView& scan, double surface, const Footprint& footprint, double reach);

}  // namespace mr_robot::navigation
