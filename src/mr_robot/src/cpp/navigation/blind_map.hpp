// What maps tell of where the laser is blind.
#pragma once

#include <vector>

#include "map.hpp"
#include "points.hpp"
#include "rollout.hpp"

namespace mr_robot::navigation {

// The walls of a map.
struct Walls {
  Map map;
  const float* distance;  // m from each cell to the nearest wall

  // m between what the laser or a map shows of one surface: what SLAM may be off by, and a cell.
  double same_surface() const { return kProgress + map.resolution; }
};

bool is_wall(const Walls& walls, const Point& point, double within);

// What is known of a place without seeing it.
class BlindMap {
 public:
  BlindMap(const Walls& merged, const Map* own, const Pose& pose, double reach);

  struct Wall {
    Point place;
    bool foreign;  // only other robots have mapped it
  };
  const std::vector<Wall>& walls() const { return walls_; }

  // Whether nothing is there, nor beside it.
  bool is_open(const Point& point) const;

 private:
  const Map& merged_;
  const Map* own_;
  double surface_;
  std::vector<Wall> walls_;
};

}  // namespace mr_robot::navigation
