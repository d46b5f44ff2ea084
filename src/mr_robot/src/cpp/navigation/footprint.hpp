// What of the ground a robot covers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "points.hpp"

namespace mr_robot::navigation {

// In the robot's frame: of the box around its middle what lies within `radius` of it. A disc has the length of its
// diameter, a box the radius of its corners.
class Footprint {
 public:
  // m. `radius` 0: that of the corners.
  Footprint(double half_length, double half_width, double radius = 0.0)
      : half_length(half_length),
        half_width(half_width),
        radius(radius > 0.0 ? std::min(radius, std::hypot(half_length, half_width))
                            : std::hypot(half_length, half_width)),
        cut_off_(this->radius < std::hypot(half_length, half_width)) {}

  // m, negative inside. Where the radius cuts off the corners, at most the true distance.
  double distance(const Point& place) const { return distance(place, kFar); }

  // Or any distance from `enough` on.
  double distance(const Point& place, double enough) const {
    const double ahead = std::abs(place.x) - half_length, beside = std::abs(place.y) - half_width;
    const double inside = std::max(ahead, beside);
    if (inside >= enough) return inside;
    const double from_box = ahead > 0.0 && beside > 0.0 ? mr_grid::length_of(ahead, beside) : inside;
    return cut_off_ ? std::max(from_box, mr_grid::length_of(place.x, place.y) - radius) : from_box;
  }

  // Left end of the rear edge (1), its middle (0) or its right end (-1).
  Point rear(double side) const {
    const Point end{-half_length, side * half_width};
    const double share = cut_off_ ? std::min(1.0, radius / mr_grid::length_of(end)) : 1.0;
    return {share * end.x, share * end.y};
  }

  const double half_length, half_width, radius;

 private:
  static constexpr double kFar = std::numeric_limits<double>::infinity();

  bool cut_off_;
};

}  // namespace mr_robot::navigation
