// Reduction of a grid to a coarser one.
#pragma once

#include <cstddef>
#include <cstdint>

namespace explorer {

// Greatest of the values (rows * columns) where `mask` is nonzero in each block of factor * factor cells, -1 without
// one, into `pooled` (ceil(rows / factor) * ceil(columns / factor)).
void pooled_maximum(const float* values, const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns,
                    std::ptrdiff_t factor, float* pooled);

}  // namespace explorer
