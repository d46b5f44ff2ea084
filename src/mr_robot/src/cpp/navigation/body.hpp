// Distances of a body from obstacle points, looked up in cells around a place.
#pragma once

#include <vector>

#include "rollout.hpp"

namespace mr_robot::navigation {

class Body {
 public:
  // `reach`: m around the place within which poses are asked about.
  // `cell`: m, of the look-up.
  Body(const Pose& place, double reach, double cell, const std::vector<Obstacle>& obstacles,
       const Footprint& footprint);

  // m, less the margins of the obstacles; `kMost` where nothing is near.
  double clearance(const Pose& pose);

  // m, the least on a short way by way of `middle`, with what the corners sweep. In the body's frame obstacles are
  // taken to move straight from pose to pose, which is 1 mm off for .1 m and a turn of .2 rad.
  double clearance(const Pose& from, const Pose& middle, const Pose& to);

  // Whether the body can turn there.
  bool roomy(const Pose& pose);

  static constexpr double kMost = 3.0 * kTouching;  // m

 private:
  struct Cell {
    bool known = false;
    std::vector<Obstacle> obstacles;
  };

  const std::vector<Obstacle>& near(const Pose& pose);
  double least_between(const Point& from, const Point& to, double enough) const;

  Footprint footprint_;
  std::vector<Obstacle> all_;
  double cell_, left_, bottom_;
  int side_;
  std::vector<Cell> cells_;
};

}  // namespace mr_robot::navigation
