// Straight lines of cells on a grid.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mr_grid/cells.hpp>

namespace explorer {

// `blocked`: nonzero where no line may pass. Whether the line between two cells (row, column), sampled
// in so many points, passes no blocked cell and none outside of the grid; its end cells do not count.
bool line_is_clear(const mr_grid::Cells<std::uint8_t>& blocked, const std::int64_t* start, const std::int64_t* end,
                   std::int64_t samples);

// The most cells in a row or column that a line between two of n pairs of cells passes.
std::int64_t longest_line(const std::int64_t* starts, const std::int64_t* ends, std::size_t n);

// Writes to `clear` which lines between n pairs of cells are clear, all sampled in as many points as the longest has
// cells.
void lines_are_clear(const mr_grid::Cells<std::uint8_t>& blocked, const std::int64_t* starts, const std::int64_t* ends,
                     std::size_t n, bool* clear);

}  // namespace explorer
