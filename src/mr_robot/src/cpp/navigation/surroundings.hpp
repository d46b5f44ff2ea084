// What a laser scan tells about obstacles around the robot, and what of it the map does not know.
#pragma once

#include <cstddef>
#include <vector>

#include "blind_map.hpp"
#include "rollout.hpp"
#include "scan.hpp"

namespace mr_robot::navigation {

struct Remembered {
  double x, y;  // m, map frame
  double time;  // s, when seen
};

struct Memory {
  double duration;   // s for which a point is remembered
  double cell;       // m, one point is kept per square of this size
  std::size_t most;  // points
};

// Distances that the footprint keeps, m, and for what may move, s by which that grows with speed. `foreign`: from walls
// that only other robots have mapped.
struct Margins {
  double wall, foreign, obstacle, moving, reaction_time;
};

// The memory after one more scan taken at `pose`: its hits that are no walls of the map, then what is left of the old.
// Of several points in a square the first is kept. What came too near to be read stays until something is read behind
// it.
std::vector<Remembered> remember(const std::vector<Remembered>& old, const ScanView& scan, const Pose& pose,
                                 const Walls& walls, const Memory& memory, double now);

// Hits, remembered points and, where the laser is blind, walls within `reach` of the robot; of each square of kTouching
// the nearest, of those close to the robot all. `own`: what the robot itself has mapped, if anything. It lies where the
// robot believes to be, while what the others drew may lie beside it: blind walls are those of `own` that are not gone
// in `walls`, and those of `walls` where `own` shows nothing.
std::vector<Obstacle> surroundings(const ScanView& scan, const Pose& pose, const std::vector<Remembered>& remembered,
                                   const Walls& walls, const Map* own, const Footprint& footprint,
                                   const Margins& margins, double reach);

// All but those farther inside the body than poses and points are inexact: where it stands nothing is, and from what it
// touches already any motion may come nearer to all the rest.
std::vector<Obstacle> outside(const std::vector<Obstacle>& obstacles, const Pose& pose, const Footprint& footprint);

}  // namespace mr_robot::navigation
