// Frontiers of an occupancy grid (Yamauchi, A frontier-based approach for autonomous exploration, 1997).
#pragma once

#include <cstddef>
#include <cstdint>
#include <mr_grid/cells.hpp>

namespace explorer {

struct OccupancyGrid {
  mr_grid::Cells<std::int8_t> cells;  // negative = unknown
  std::int8_t free_below, occupied_from;
};

// Writes to `frontier` (rows * columns) which cells are free, have an unknown cell among their 8 neighbours and no
// occupied one. Islands of fewer than `smallest_unknown` unknown cells (4 neighbours a cell) do not count, nor do
// frontiers of fewer than `smallest_frontier` cells; cells no more than three apart belong to one frontier.
void frontier_cells(const OccupancyGrid& map, std::size_t smallest_unknown, std::size_t smallest_frontier,
                    bool* frontier);

// Writes to `large` which of n cells, ascending indices of a grid with so many columns, belong to a frontier of at
// least `smallest` of them.
void large_frontiers(const std::int64_t* cells, std::size_t n, std::ptrdiff_t columns, std::size_t smallest,
                     bool* large);

}  // namespace explorer
