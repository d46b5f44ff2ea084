// Points of walls.
#pragma once

#include <mr_grid/pose.hpp>

namespace map_merger {

using mr_grid::Frame;
using mr_grid::Pose;

// A point of a wall in metres, and its unit normal towards free space.
struct OrientedPoint {
  double x, y, normal_x, normal_y;
};

inline OrientedPoint operator*(const Frame& frame, const OrientedPoint& point) {
  const mr_grid::Point place = frame * mr_grid::Point{point.x, point.y};
  const mr_grid::Point normal = frame.turned({point.normal_x, point.normal_y});
  return {place.x, place.y, normal.x, normal.y};
}

}  // namespace map_merger
