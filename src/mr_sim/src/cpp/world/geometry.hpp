// Plane geometry of the world engine. SI units, angles in radians, counter-clockwise.
#pragma once

#include <mr_grid/pose.hpp>
#include <vector>

namespace mr_sim {

using mr_grid::Point;
using mr_grid::Pose;
using Polygon = std::vector<Point>;

// Distance along the ray to the segment a-b, infinity when it misses. `direction` is a unit vector.
double ray_segment(const Point& origin, const Point& direction, const Point& a, const Point& b);

// Whether two simple polygons share a point.
bool overlap(const Polygon& a, const Polygon& b);

}  // namespace mr_sim
