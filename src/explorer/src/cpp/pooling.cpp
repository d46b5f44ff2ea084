#include "pooling.hpp"

#include <algorithm>
#include <vector>

namespace explorer {
namespace {

bool holds_any(const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns, std::int64_t row,
               std::int64_t column, std::ptrdiff_t reach) {
  const std::int64_t left = std::max<std::int64_t>(column - reach, 0);
  const std::int64_t right = std::min<std::int64_t>(column + reach, columns - 1);
  const std::int64_t bottom = std::min<std::int64_t>(row + reach, rows - 1);
  if (left > right) return false;
  for (std::int64_t r = std::max<std::int64_t>(row - reach, 0); r <= bottom; ++r) {
    const std::uint8_t* cells = mask + r * columns;
    if (std::any_of(cells + left, cells + right + 1, [](std::uint8_t cell) { return cell != 0; })) return true;
  }
  return false;
}

}  // namespace

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

void any_in_box(const std::uint8_t* mask, std::ptrdiff_t rows, std::ptrdiff_t columns, const std::int64_t* cells,
                std::size_t n, std::ptrdiff_t reach, bool* near) {
  for (std::size_t i = 0; i < n; ++i) near[i] = holds_any(mask, rows, columns, cells[2 * i], cells[2 * i + 1], reach);
}

}  // namespace explorer
