// Straight lines of cells on a grid.
#pragma once

#include <cstddef>
#include <cstdint>

namespace explorer {

// `blocked`: rows * columns, nonzero where no line may pass. Writes to `clear` whether the lines between n pairs of
// cells (row, column) pass no blocked cell and none outside of the grid; their end cells do not count. All lines are
// sampled in as many points as the longest has cells.
void lines_are_clear(const std::uint8_t* blocked, std::ptrdiff_t rows, std::ptrdiff_t columns,
                     const std::int64_t* starts, const std::int64_t* ends, std::size_t n, bool* clear);

}  // namespace explorer
