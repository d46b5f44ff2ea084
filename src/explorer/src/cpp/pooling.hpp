// What there is in parts of a grid.
#pragma once

#include <cstddef>
#include <cstdint>

namespace explorer {

// Greatest of the values (rows * columns) where `mask` is nonzero in each block of factor * factor cells, -1 without
// one, into `pooled` (ceil(rows / factor) * ceil(columns / factor)).
void pooled_maximum(const float* values, const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns,
                    std::ptrdiff_t factor, float* pooled);

// Writes to `near` for which of n cells (row, column) of the grid a cell of `mask` (rows * columns) is nonzero that is
// no more than `reach` rows and columns away.
void any_in_box(const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns, const std::int64_t* cells,
                std::size_t n, std::ptrdiff_t reach, bool* near);

}  // namespace explorer
