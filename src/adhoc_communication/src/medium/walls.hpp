// Walls between robots, from an occupancy raster.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "propagation/position.hpp"

namespace adhoc_communication {

/// Without cells there are no walls; outside the raster there are none either.
struct Walls {
  std::vector<std::uint8_t> cells;  ///< row by row from the lower left; not zero: wall
  std::size_t width = 0;            ///< cells in a row
  double resolution = 0.05;         ///< metres per cell
  Position origin;                  ///< lower left corner of the first cell

  bool occupied(std::int64_t column, std::int64_t row) const;
};

/// Walls that the straight line from `a` to `b` crosses: unbroken runs of occupied cells, however thick. The same in
/// both directions.
int walls_between(const Walls& walls, const Position& a, const Position& b);

}  // namespace adhoc_communication
