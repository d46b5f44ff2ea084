// The border between obstacles and free space as oriented points.
#pragma once

#include <cstdint>
#include <vector>

#include "oriented_point.hpp"

namespace map_merger {

// A grid of rows * columns cells, one byte each; cell (0, 0) has its corner at the origin.
struct Raster {
  const std::uint8_t* cells;
  int rows, columns;
  double resolution;  // m per cell
  Pose origin;

  std::uint8_t at(int row, int column) const { return cells[static_cast<std::int64_t>(row) * columns + column]; }
};

struct ObstacleCell {
  int row, column;
};

struct BorderPoint {
  OrientedPoint point;
  std::size_t cell;  // number of the obstacle cell it belongs to
};

// Of each obstacle cell of `cells` the faces to `free` cells: first those on one side of all walls, then those on the
// other. Cells whose surroundings are no line have none.
std::vector<BorderPoint> border_of(const std::vector<ObstacleCell>& cells, const Raster& free);

}  // namespace map_merger
