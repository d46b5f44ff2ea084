#include "lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace explorer {
namespace {

struct Line {
  std::int64_t row, column, end_row, end_column;
};

bool is_clear(const std::uint8_t* blocked, std::ptrdiff_t rows, std::ptrdiff_t columns, const Line& line,
              std::int64_t steps) {
  const double down = static_cast<double>(line.end_row - line.row);
  const double right = static_cast<double>(line.end_column - line.column);
  for (std::int64_t step = 1; step < steps; ++step) {
    const double part = static_cast<double>(step) / static_cast<double>(steps);
    const auto row = static_cast<std::int64_t>(std::nearbyint(static_cast<double>(line.row) + down * part));
    const auto column = static_cast<std::int64_t>(std::nearbyint(static_cast<double>(line.column) + right * part));
    if ((row == line.row && column == line.column) || (row == line.end_row && column == line.end_column)) continue;
    if (row < 0 || column < 0 || row >= rows || column >= columns || blocked[row * columns + column]) return false;
  }
  return true;
}

}  // namespace

void lines_are_clear(const std::uint8_t* blocked, std::ptrdiff_t rows, std::ptrdiff_t columns,
                     const std::int64_t* starts, const std::int64_t* ends, std::size_t n, bool* clear) {
  std::int64_t steps = 0;
  for (std::size_t i = 0; i < 2 * n; ++i) steps = std::max<std::int64_t>(steps, std::llabs(ends[i] - starts[i]));
  for (std::size_t i = 0; i < n; ++i) {
    const Line line{starts[2 * i], starts[2 * i + 1], ends[2 * i], ends[2 * i + 1]};
    clear[i] = is_clear(blocked, rows, columns, line, steps);
  }
}

}  // namespace explorer
