// Where a robot is.
#pragma once

#include <cmath>

namespace adhoc_communication {

/// Planar position in the world, metres.
struct Position {
  double x = 0.0;
  double y = 0.0;
};

inline bool operator==(const Position& a, const Position& b) { return a.x == b.x && a.y == b.y; }
inline double distance_between(const Position& a, const Position& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace adhoc_communication
