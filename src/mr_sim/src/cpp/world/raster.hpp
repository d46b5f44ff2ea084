// Walls and furniture as a raster of occupied cells, with exact ray casting.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry.hpp"

namespace mr_sim {

class Raster {
 public:
  // `occupied`: rows * columns values, row 0 at the bottom; `origin`: lower left corner of cell (0, 0) in metres.
  // `intensities`: of the echo from each cell, as many values; null: 1 from all.
  Raster(const uint8_t* occupied, int rows, int columns, double resolution, Point origin,
         const float* intensities = nullptr);

  // Distance in metres from `origin` to the first occupied cell along the unit vector `direction`; `max_range` when
  // there is none nearer. Everything outside the raster is free. `intensity`, unless null: of its echo, 0 without one.
  double cast(const Point& origin, const Point& direction, double max_range, float* intensity = nullptr) const;

  // Whether the segment touches an occupied cell.
  bool touches(const Point& a, const Point& b) const;

  bool occupied(const Point& point) const;

 private:
  bool enter(double x, double y, const Point& direction, double limit, double* travelled) const;
  void measure_clearance(const uint8_t* occupied, int step_x, int step_y, std::vector<uint8_t>* clearance);

  int rows_;
  int columns_;
  double resolution_;
  Point origin_;
  // Per cell and quadrant of directions (1: towards larger x, 2: towards larger y) the side in cells, at most 255, of
  // the largest free square that has the cell in its near corner: a ray into that quadrant may cross it at once.
  std::array<std::vector<uint8_t>, 4> clearance_;
  std::vector<float> intensities_;  // empty: all 1
};

}  // namespace mr_sim
