#include "nearness.hpp"

#include <algorithm>

namespace map_merger {

void lower_around(const Place& place, std::int64_t radius, const Window& window, std::int32_t* squares) {
  const std::int64_t top = std::max(window.top, place.row - radius),
                     bottom = std::min(window.bottom, place.row + radius + 1),
                     left = std::max(window.left, place.column - radius),
                     right = std::min(window.right, place.column + radius + 1);
  for (std::int64_t row = top; row < bottom; ++row) {
    std::int32_t* line = squares + (row - window.top) * (window.right - window.left) - window.left;
    const std::int64_t down = row - place.row;
    for (std::int64_t column = left; column < right; ++column) {
      const std::int64_t across = column - place.column, square = down * down + across * across;
      if (square <= radius * radius) line[column] = std::min(line[column], static_cast<std::int32_t>(square));
    }
  }
}

}  // namespace map_merger
