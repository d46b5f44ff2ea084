// The border between obstacles and free space as oriented points.
#pragma once

#include <cstdint>
#include <mr_grid/cells.hpp>
#include <vector>

#include "oriented_point.hpp"

namespace map_merger {

// Cells that lie in a frame at an angle, cell (0, 0) with its corner at the origin.
struct Raster : mr_grid::Cells<std::uint8_t> {
  double resolution;  // m per cell
  Pose origin;
};

struct BorderPoint {
  OrientedPoint point;
  std::size_t cell;  // number of the obstacle cell it belongs to
};

// Of each obstacle cell of `cells` the faces to `free` cells: first those on one side of all walls, then those on the
// other. Cells whose surroundings are no line have none.
std::vector<BorderPoint> border_of(const std::vector<mr_grid::Cell>& cells, const Raster& free);

}  // namespace map_merger
