#include "body.hpp"

#include <algorithm>
#include <cmath>

namespace mr_robot::navigation {
Body::Body(const Pose& place, double reach, double cell, const std::vector<Obstacle>& obstacles,
           const Footprint& footprint)
    : footprint_(footprint),
      all_(obstacles),
      cell_(cell),
      left_(place.x - reach),
      bottom_(place.y - reach),
      side_(static_cast<int>(std::ceil(2.0 * reach / cell)) + 1),
      cells_(static_cast<std::size_t>(side_) * side_) {}

double Body::clearance(const Pose& pose) {
  const mr_grid::Frame body(pose);
  double least = kMost;
  for (const Obstacle& point : near(pose)) {
    least = std::min(least, footprint_.distance(body.seen({point.x, point.y})) - point.margin);
  }
  return least;
}

double Body::clearance(const Pose& from, const Pose& middle, const Pose& to) {
  const mr_grid::Frame before(from), between(middle), after(to);
  double least = kMost;
  for (const Obstacle& obstacle : near(middle)) {
    const Point point{obstacle.x, obstacle.y};
    const Point half_way = between.seen(point);
    const double enough = least + obstacle.margin;
    least = std::min({least, least_between(before.seen(point), half_way, enough) - obstacle.margin,
                      least_between(half_way, after.seen(point), enough) - obstacle.margin});
  }
  return least;
}

// Of the points between two in the body's frame the distance of the closest one, or any distance of at least `enough`.
// The distance from a footprint has one minimum on a line, which is closed in on.
double Body::least_between(const Point& from, const Point& to, double enough) const {
  const double at_from = footprint_.distance(from), at_to = footprint_.distance(to);
  const double at_ends = std::min(at_from, at_to);
  const double length = distance(from, to);
  if (0.5 * (at_from + at_to - length) >= enough) return at_ends;
  const auto at = [&](double share) {
    return footprint_.distance({from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)});
  };
  double low = 0.0, high = 1.0;
  while ((high - low) * length > kSlack) {
    const double third = (high - low) / 3.0;
    if (at(low + third) < at(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return std::min(at_ends, at(0.5 * (low + high)));
}

bool Body::roomy(const Pose& pose) {
  for (const Obstacle& point : near(pose)) {
    if (std::hypot(point.x - pose.x, point.y - pose.y) - point.margin < footprint_.radius + kTouching) return false;
  }
  return true;
}

const std::vector<Obstacle>& Body::near(const Pose& pose) {
  const int column = std::clamp(static_cast<int>((pose.x - left_) / cell_), 0, side_ - 1);
  const int row = std::clamp(static_cast<int>((pose.y - bottom_) / cell_), 0, side_ - 1);
  Cell& cell = cells_[static_cast<std::size_t>(row) * side_ + column];
  if (!cell.known) {
    cell.known = true;
    const double x = left_ + (column + 0.5) * cell_, y = bottom_ + (row + 0.5) * cell_;
    for (const Obstacle& point : all_) {
      const double dx = point.x - x, dy = point.y - y, reach = footprint_.radius + kMost + cell_ + point.margin;
      if (dx * dx + dy * dy < reach * reach) cell.obstacles.push_back(point);
    }
  }
  return cell.obstacles;
}

}  // namespace mr_robot::navigation
