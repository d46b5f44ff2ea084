// What several maps on one lattice say together about each cell. The rules are stated in weighing.py.
#pragma once

#include <cstdint>
#include <vector>

#include "mask.hpp"

namespace map_merger {

// What a map knows: no cell is both.
struct Known {
  Mask wall, floor;
};

// Of cells row by row.
Known known_of(const std::int8_t* cells, std::int64_t rows, std::int64_t columns);

// Cells up to which two maps of one wall lie apart, and cells around a wall in which floor refutes it.
struct Tolerance {
  std::int64_t same_wall, seen_through;
};

// The map of all maps (one at least), which count in their order. locked: what the first one knows stays as it is.
Known weighed(const std::vector<Known>& maps, bool locked, const Tolerance& tolerance);

}  // namespace map_merger
