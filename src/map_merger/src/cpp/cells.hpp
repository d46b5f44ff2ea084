// Boxes around cells of maps, and writing into a map.
#pragma once

#include <cstdint>

#include "drawing.hpp"

namespace map_merger {

// Smallest window around the cells in which two maps of rows * columns differ, all zero if they are equal. The second
// one may have a single row that stands for all (second_step 0); otherwise second_step is `columns`.
Window window_of_differences(const std::int8_t* first, const std::int8_t* second, std::int64_t second_step,
                             std::int64_t rows, std::int64_t columns);

// A map that is written to. stamps: with which stamp each cell was written, or null.
struct Store {
  std::int8_t* cells;
  std::int32_t* stamps;
  std::int64_t columns;
};

// Writes cells row by row into the window of the store, but not over newer ones; known_only: unknown cells say nothing.
// Returns the window around what changed, all zero if nothing did.
Window write_cells(const Store& store, const Window& window, const std::int8_t* cells, std::int32_t stamp,
                   bool known_only);

}  // namespace map_merger
