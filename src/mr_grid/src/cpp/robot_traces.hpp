// What an occupancy grid shows of robots.
#pragma once

#include <cstdint>
#include <mr_grid/cells.hpp>
#include <vector>

namespace mr_grid {

struct OccupancyGrid : Grid<std::int8_t> {
  int occupied_from;

  bool occupied(int row, int column) const { return at(row, column) >= occupied_from; }
};

// The cells of obstacles of `largest`, m, at most whose middle lies within `most_apart`, m, of one of the places.
std::vector<Cell> robot_traces(const OccupancyGrid& grid, const std::vector<Point>& places, double most_apart,
                               double largest);

}  // namespace mr_grid
