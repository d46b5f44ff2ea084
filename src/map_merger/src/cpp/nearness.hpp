// How near the cells of a map are to places.
#pragma once

#include <cstdint>

#include "drawing.hpp"

namespace map_merger {

struct Place {
  std::int64_t row, column;
};

// Lowers each value of the window (rows * columns, row by row) to the squared distance in cells to the place, for cells
// at most `radius` cells from it.
void lower_around(const Place& place, std::int64_t radius, const Window& window, std::int32_t* squares);

}  // namespace map_merger
