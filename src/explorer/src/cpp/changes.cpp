#include "changes.hpp"

#include <algorithm>
#include <cstring>

namespace explorer {

void changed_tiles(const std::int8_t* before, const std::int8_t* after, std::ptrdiff_t rows, std::ptrdiff_t columns,
                   std::ptrdiff_t edge, bool* changed) {
  const std::ptrdiff_t across = (columns + edge - 1) / edge;
  std::fill_n(changed, (rows + edge - 1) / edge * across, false);
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    const std::ptrdiff_t first = row * columns;
    if (std::memcmp(before + first, after + first, static_cast<std::size_t>(columns)) == 0) continue;
    bool* tiles = changed + row / edge * across;
    for (std::ptrdiff_t tile = 0; tile < across; ++tile) {
      const std::ptrdiff_t left = tile * edge, length = std::min(edge, columns - left);
      if (tiles[tile]) continue;
      tiles[tile] = std::memcmp(before + first + left, after + first + left, static_cast<std::size_t>(length)) != 0;
    }
  }
}

}  // namespace explorer
