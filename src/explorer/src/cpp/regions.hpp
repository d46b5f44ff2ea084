// Connected parts of a grid.
#pragma once

#include <cstddef>
#include <cstdint>

namespace explorer {

// Writes to `part` (rows * columns) which of the set cells (1, else 0) are connected with the cell at `start` through
// set cells with 8 neighbours each; none if that cell is not set.
void connected_part(const std::uint8_t* cells, std::ptrdiff_t rows, std::ptrdiff_t columns, std::ptrdiff_t start,
                    bool* part);

// Writes to `near` (rows * columns) which of the set cells can be reached from the `n` `seeds`, flat indices, through
// set cells with 8 neighbours each in at most so many steps; seeds that are not set reach nothing.
void cells_within(const std::uint8_t* cells, std::ptrdiff_t rows, std::ptrdiff_t columns, const std::int64_t* seeds,
                  std::size_t n, int steps, bool* near);

}  // namespace explorer
