// The obstacles of a map that are walls.
#pragma once

#include <cstdint>
#include <vector>

#include "border.hpp"
#include "mask.hpp"

namespace map_merger {

struct Walls {
  std::vector<mr_grid::Cell> cells;  // row by row
  std::vector<bool> large;           // of each cell: the extent of its obstacle
};

// Obstacles of `smallest` cells or more. Those whose extent is more than `largest_mover`, in cells, are large.
Walls walls_of(const Mask& obstacles, std::int64_t smallest, double largest_mover);

// Clears the cells, one byte each, whose middle is at most `radius` cells from that of one of `centres`.
void clear_discs(std::uint8_t* cells, std::int64_t rows, std::int64_t columns,
                 const std::vector<mr_grid::Cell>& centres, double radius);

}  // namespace map_merger
