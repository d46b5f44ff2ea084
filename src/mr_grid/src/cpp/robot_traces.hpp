// What an occupancy grid shows of robots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace mr_grid {

using Place = std::pair<double, double>;  // x, y in m

struct Cell {
  int row, column;
};

struct Grid {
  const std::int8_t* cells;
  int rows, columns;
  int occupied_from;
  double resolution;  // m
  Place origin;       // m

  bool occupied(int row, int column) const {
    return cells[static_cast<std::size_t>(row) * columns + column] >= occupied_from;
  }
};

// The cells of obstacles of `largest`, m, at most whose middle lies within `most_apart`, m, of one of the places.
std::vector<Cell> robot_traces(const Grid& grid, const std::vector<Place>& places, double most_apart, double largest);

}  // namespace mr_grid
