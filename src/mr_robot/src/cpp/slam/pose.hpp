// Poses as SLAM uses them.
#pragma once

#include <mr_grid/pose.hpp>

namespace mr_robot::slam {

using mr_grid::Frame;
using mr_grid::length_of;
using mr_grid::normalized;
using mr_grid::Point;
using mr_grid::Pose;

inline double distance(const Pose& a, const Pose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

// `most`, m, and `angle`, rad.
inline bool apart(const Pose& a, const Pose& b, double most, double angle) {
  return distance(a, b) >= most || std::abs(normalized(a.yaw - b.yaw)) >= angle;
}

}  // namespace mr_robot::slam
