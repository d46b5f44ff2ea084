#include "blind_map.hpp"

#include <algorithm>
#include <cmath>

namespace mr_robot::navigation {
namespace {

std::vector<Point> walls_near(const Map& map, const Pose& pose, double reach) {
  std::vector<Point> points;
  const auto first = [&](double from) { return static_cast<int>(std::clamp(std::floor(from), 0.0, 1e9)); };
  const auto last = [&](double to, int count) {
    return static_cast<int>(std::clamp(std::floor(to), -1.0, count - 1.0));
  };
  const double column = (pose.x - map.origin.x) / map.resolution, row = (pose.y - map.origin.y) / map.resolution;
  const double cells = reach / map.resolution;
  for (int r = first(row - cells); r <= last(row + cells, map.rows); ++r) {
    for (int c = first(column - cells); c <= last(column + cells, map.columns); ++c) {
      if (map.at(r, c) > 50) points.push_back(map.middle_of(r, c));
    }
  }
  return points;
}

}  // namespace

bool is_wall(const Walls& walls, const Point& point, double within) {
  const auto index = walls.map.index_of(point);
  return index && walls.distance[*index] < static_cast<float>(within);
}

BlindMap::BlindMap(const Walls& merged, const Map* own, const Pose& pose, double reach)
    : merged_(merged.map), own_(own), surface_(merged.same_surface()) {
  for (const Point& wall : walls_near(merged.map, pose, reach)) {
    if (own == nullptr || !is_known(*own, wall)) walls_.push_back({wall, own != nullptr});
  }
  if (own == nullptr) return;
  for (const Point& wall : walls_near(*own, pose, reach)) {
    if (is_wall(merged, wall, surface_)) walls_.push_back({wall, false});
  }
}

bool BlindMap::is_open(const Point& point) const {
  const bool known = (own_ != nullptr && is_known(*own_, point)) || is_known(merged_, point);
  return known && std::none_of(walls_.begin(), walls_.end(),
                               [&](const Wall& wall) { return within(wall.place, point, surface_); });
}

}  // namespace mr_robot::navigation
