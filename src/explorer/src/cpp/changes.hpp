// What differs between two maps.
#pragma once

#include <cstddef>
#include <cstdint>

namespace explorer {

// Writes to `changed` (ceil(rows / edge) * ceil(columns / edge)) in which tiles of edge * edge cells two grids of
// rows * columns cells differ.
void changed_tiles(const std::int8_t* before, const std::int8_t* after, std::ptrdiff_t rows, std::ptrdiff_t columns,
                   std::ptrdiff_t edge, bool* changed);

}  // namespace explorer
