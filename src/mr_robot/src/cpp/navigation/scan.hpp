// A laser scan, and what it says of places.
#pragma once

#include <cstddef>
#include <vector>

#include "points.hpp"

namespace mr_robot::navigation {

struct ScanView {
  const Point* points;  // hits, robot's frame
  std::size_t point_count;
  const double* ranges;  // m by beam, 0 = not valid
  std::size_t range_count;
  double angle_min, angle_increment;  // rad
  double range_min;                   // m, nearer than which it reads nothing
  Pose mount;                         // of the laser on the robot
};

// What a laser's readings say: sets those that are none to 0 and the rest to at most `range_max`, and returns the hits
// in the robot's frame. `directions`: unit vectors of the beams; `mount`: place of the laser on the robot.
std::vector<Point> hits(double* ranges, std::size_t count, const Point* directions, double range_min, double range_max,
                        const Point& mount);

// What the scan reads in the direction of the point, m; 0 beside its field of view and where nothing is valid. Angles
// of lasers run from -pi on as well as from 0. `eye`: where the laser is, `heading`: rad, where it looks.
double reading_towards(const Point& point, const Point& eye, double heading, const ScanView& scan);

// Whether the scan looks through the point, or would hit it if it were still there.
bool seen_gone(const Point& point, const Point& eye, double heading, const ScanView& scan, double beyond);

// Whether the point is in the field of view but too near to be read, and nothing is read behind it.
bool too_near(const Point& point, const Point& eye, double heading, const ScanView& scan);

// Whether a valid reading of the scan goes in that direction, so that it would show what is there.
bool in_view(const Point& point, const Point& eye, double heading, const ScanView& scan);

}  // namespace mr_robot::navigation
