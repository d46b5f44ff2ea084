#include "body.hpp"

#include <algorithm>
#include <cmath>

namespace mr_robot::navigation {

Body::Body(const Pose& place, double reach, double cell, const std::vector<Obstacle>& obstacles,
           const Footprint& footprint)
    : footprint_(footprint),
      all_(obstacles),
      cell_(cell),
      circle_(std::hypot(footprint.half_length, footprint.half_width)),
      left_(place.x - reach),
      bottom_(place.y - reach),
      side_(static_cast<int>(std::ceil(2.0 * reach / cell)) + 1),
      cells_(static_cast<std::size_t>(side_) * side_) {}

double Body::clearance(const Pose& pose) {
  const mr_grid::Frame body(pose);
  double least = kMost;
  for (const Obstacle& point : near(pose)) {
    const Point place = body.seen({point.x, point.y});
    const double ahead = std::abs(place.x) - footprint_.half_length;
    const double beside = std::abs(place.y) - footprint_.half_width;
    const double inside = std::max(ahead, beside) - point.margin;
    if (inside >= least) continue;
    least = std::min(least, ahead > 0.0 && beside > 0.0 ? std::hypot(ahead, beside) - point.margin : inside);
  }
  return least;
}

bool Body::roomy(const Pose& pose) {
  for (const Obstacle& point : near(pose)) {
    if (std::hypot(point.x - pose.x, point.y - pose.y) - point.margin < circle_ + kTouching) return false;
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
      const double dx = point.x - x, dy = point.y - y, reach = circle_ + kMost + cell_ + point.margin;
      if (dx * dx + dy * dy < reach * reach) cell.obstacles.push_back(point);
    }
  }
  return cell.obstacles;
}

}  // namespace mr_robot::navigation
