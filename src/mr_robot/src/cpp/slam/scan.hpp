// One sweep of a laser, reduced to what mapping and matching need.
#pragma once

#include <cstddef>
#include <vector>

#include "pose.hpp"

namespace mr_robot::slam {

struct LaserGeometry {
  double angle_min, angle_increment;  // rad
  double range_min, range_max;        // m
  Pose mount;                         // laser in the robot's frame
  Pose swept{};                       // robot at the last beam seen from where it was at the first
};

struct ScanOptions {
  // m, things that stand free up to this size may be robots: the largest of the team, from end to end, and some more
  double small_object_size;
  double surface_window = 0.15;  // m, neighbours up to this far apart form a surface
  // m, beams that hit nothing show no free space beyond: a laser of a long range gives none for glass and black cloth
  double free_range = 20.0;
  // m from the laser, from which on what is hit counts as nothing: the map would grow to hold it
  double reach = 80.0;
};

struct Beam {
  Point end;  // frame of the robot at the first beam; where free space ends
  bool hit;   // false: nothing up to range_max, the beam shows free space only, and that up to free_range
  bool on_small_object = false;
  bool has_normal = false;  // the surface is seen densely enough to know its direction
  Point normal{};           // robot's frame, towards the laser
  double spacing = 0.0;     // m along the surface from one beam to the next
  std::size_t index = 0;    // of its reading
};

struct Scan {
  Point eye;  // laser in the robot's frame
  std::vector<Beam> beams;
  bool all_around = false;  // the first beam goes beside the last one
};

// Beams are put where the robot was when each was taken, as if it had moved evenly from the first to the last one.
// Readings that are NaN, negative or below range_min are dropped; infinity or range_max and above mean free space.
Scan make_scan(const float* ranges, std::size_t size, const LaserGeometry& geometry, const ScanOptions& options);

constexpr double kHitSpacing = 0.04;  // m between hits that are used, so that near walls do not outweigh far ones

// Hits on surfaces, about `kHitSpacing` apart; none on small objects, which may be robots that drive along.
std::vector<const Beam*> spaced_hits(const Scan& scan);

}  // namespace mr_robot::slam
