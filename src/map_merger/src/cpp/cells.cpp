#include "cells.hpp"

#include <algorithm>
#include <cstring>

#include "cell_values.hpp"

namespace map_merger {
namespace {

std::uint64_t eight(const std::int8_t* cells) {
  std::uint64_t word;
  std::memcpy(&word, cells, sizeof word);
  return word;
}

// The first column from `from` on in which the rows differ; `to` if there is none.
std::int64_t first_difference(const std::int8_t* one, const std::int8_t* other, std::int64_t from, std::int64_t to) {
  while (from + 8 <= to && eight(one + from) == eight(other + from)) from += 8;
  while (from < to && one[from] == other[from]) ++from;
  return from;
}

// One beyond the last column before `to` in which they differ; `from` if there is none.
std::int64_t last_difference(const std::int8_t* one, const std::int8_t* other, std::int64_t from, std::int64_t to) {
  while (to - 8 >= from && eight(one + to - 8) == eight(other + to - 8)) to -= 8;
  while (to > from && one[to - 1] == other[to - 1]) --to;
  return to;
}

}  // namespace

Window window_of_differences(const std::int8_t* first, const std::int8_t* second, std::int64_t second_step,
                             std::int64_t rows, std::int64_t columns) {
  Window found{rows, columns, 0, 0};
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::int8_t *one = first + row * columns, *other = second + row * second_step;
    const std::int64_t left = first_difference(one, other, 0, columns);
    if (left == columns) continue;
    found = {std::min(found.top, row), std::min(found.left, left), row + 1,
             std::max(found.right, last_difference(one, other, std::max(left, found.right), columns))};
    found.right = std::max(found.right, left + 1);
  }
  return found.bottom ? found : Window{0, 0, 0, 0};
}

Window write_cells(const Store& store, const Window& window, const std::int8_t* cells, std::int32_t stamp,
                   bool known_only) {
  Window changed{window.bottom, window.right, window.top, window.left};
  for (std::int64_t row = window.top; row < window.bottom; ++row) {
    for (std::int64_t column = window.left; column < window.right; ++column) {
      const std::int8_t cell = *cells++;
      const std::int64_t place = row * store.columns + column;
      if (known_only && cell == kUnknown) continue;
      if (store.stamps) {
        if (store.stamps[place] > stamp) continue;
        store.stamps[place] = stamp;
      }
      if (store.cells[place] == cell) continue;
      store.cells[place] = cell;
      changed = {std::min(changed.top, row), std::min(changed.left, column), row + 1,
                 std::max(changed.right, column + 1)};
    }
  }
  return changed.top < changed.bottom ? changed : Window{0, 0, 0, 0};
}

}  // namespace map_merger
