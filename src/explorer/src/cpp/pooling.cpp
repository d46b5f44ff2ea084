#include "pooling.hpp"

#include <algorithm>

namespace explorer {

void pooled_maximum(const float* values, const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns,
                    std::ptrdiff_t factor, float* pooled) {
  const std::ptrdiff_t width = (columns + factor - 1) / factor, height = (rows + factor - 1) / factor;
  std::fill_n(pooled, width * height, -1.0F);
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    float* block = pooled + row / factor * width;
    const float* value = values + row * columns;
    const std::uint8_t* chosen = mask + row * columns;
    for (std::ptrdiff_t first = 0; first < columns; first += factor, ++block) {
      const std::ptrdiff_t end = std::min(first + factor, columns);
      float greatest = *block;
      for (std::ptrdiff_t column = first; column < end; ++column) {
        greatest = std::max(greatest, chosen[column] ? value[column] : -1.0F);
      }
      *block = greatest;
    }
  }
}

}  // namespace explorer
