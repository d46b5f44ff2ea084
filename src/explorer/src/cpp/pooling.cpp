#include "pooling.hpp"

#include <algorithm>
#include <vector>

namespace explorer {

void pooled_maximum(const float* values, const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns,
                    std::ptrdiff_t factor, float* pooled) {
  std::vector<float> greatest(static_cast<std::size_t>(columns));
  for (std::ptrdiff_t top = 0; top < rows; top += factor) {
    std::fill(greatest.begin(), greatest.end(), -1.0F);
    const std::ptrdiff_t bottom = std::min(top + factor, rows);
    for (std::ptrdiff_t row = top; row < bottom; ++row) {
      const float* value = values + row * columns;
      const std::uint8_t* chosen = mask + row * columns;
      for (std::ptrdiff_t column = 0; column < columns; ++column) {
        const float candidate = chosen[column] ? value[column] : -1.0F;
        greatest[column] = candidate > greatest[column] ? candidate : greatest[column];
      }
    }
    for (std::ptrdiff_t left = 0; left < columns; left += factor) {
      const auto end = greatest.begin() + std::min(left + factor, columns);
      *pooled++ = *std::max_element(greatest.begin() + left, end);
    }
  }
}

}  // namespace explorer
