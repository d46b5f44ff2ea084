// Connected obstacles of a map.
#pragma once

#include <cstdint>
#include <vector>

#include "mask.hpp"

namespace map_merger {

// Obstacle cells [left, right) of a row, and the number of their obstacle.
struct Run {
  std::int64_t row, left, right;
  std::size_t obstacle;
};

struct Obstacle {
  std::int64_t top, left, bottom, right;  // box around it, the last two not included
  std::int64_t area = 0;                  // cells
  std::int64_t rows = 0, columns = 0;     // sums of the cells' rows and columns
};

struct Obstacles {
  std::vector<Run> runs;
  std::vector<Obstacle> all;
};

// Connected over 8 neighbours.
Obstacles obstacles_of(const Mask& walls);

}  // namespace map_merger
