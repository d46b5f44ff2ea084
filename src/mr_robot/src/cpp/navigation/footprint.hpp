// What of the ground a robot covers.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

  // Points of its edge behind the middle, no farther apart than `step`, m.
  std::vector<Point> rear(double step) const {
    std::vector<Point> edge;
    const auto add = [&](const Point& from, const Point& to) {
      const int steps =
          std::max(1, static_cast<int>(std::ceil(mr_grid::length_of(to.x - from.x, to.y - from.y) / step)));
      for (int i = 0; i <= steps; ++i) {
        const double share = static_cast<double>(i) / steps;
        edge.push_back(cut_off({from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)}));
      }
    };
    add({0.0, half_width}, {-half_length, half_width});
    add({-half_length, half_width}, {-half_length, -half_width});
    add({-half_length, -half_width}, {0.0, -half_width});
    return edge;
  }

  const double half_length, half_width, radius;

 private:
  // The place, or where the radius cuts off the way to it from the middle.
  Point cut_off(const Point& place) const {
    const double share = cut_off_ ? std::min(1.0, radius / mr_grid::length_of(place)) : 1.0;
    return {share * place.x, share * place.y};
  }

  static constexpr double kFar = std::numeric_limits<double>::infinity();

  bool cut_off_;
};

}  // namespace mr_robot::navigation
