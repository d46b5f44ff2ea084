#include "lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace explorer {
namespace {

struct Line {
  std::int64_t row, column, end_row, end_column;
};

// As std::nearbyint, in place of a call for each sample; for cells it is exact.
std::int64_t rounded(double value) {
  constexpr double kIntegersOnly = 6755399441055744.0;  // 1.5 * 2^52: around it doubles are whole numbers
  return static_cast<std::int64_t>((value + kIntegersOnly) - kIntegersOnly);
}

bool is_clear(const mr_grid::Cells<std::uint8_t>& blocked, const Line& line, std::int64_t steps) {
  const double down = static_cast<double>(line.end_row - line.row);
  const double right = static_cast<double>(line.end_column - line.column);
  for (std::int64_t step = 1; step < steps; ++step) {
    const double part = static_cast<double>(step) / static_cast<double>(steps);
    const std::int64_t row = rounded(static_cast<double>(line.row) + down * part);
    const std::int64_t column = rounded(static_cast<double>(line.column) + right * part);
    if ((row == line.row && column == line.column) || (row == line.end_row && column == line.end_column)) continue;
    if (!blocked.contains(row, column) || blocked.at(row, column)) return false;
  }
  return true;
}

}  // namespace

bool line_is_clear(const mr_grid::Cells<std::uint8_t>& blocked, const std::int64_t* start, const std::int64_t* end,
                   std::int64_t samples) {
  return is_clear(blocked, {start[0], start[1], end[0], end[1]}, samples);
}

std::int64_t longest_line(const std::int64_t* starts, const std::int64_t* ends, std::size_t n) {
  std::int64_t longest = 0;
  for (std::size_t i = 0; i < 2 * n; ++i) longest = std::max<std::int64_t>(longest, std::llabs(ends[i] - starts[i]));
  return longest;
}

void lines_are_clear(const mr_grid::Cells<std::uint8_t>& blocked, const std::int64_t* starts, const std::int64_t* ends,
                     std::size_t n, bool* clear) {
  const std::int64_t samples = longest_line(starts, ends, n);
  for (std::size_t i = 0; i < n; ++i) {
    clear[i] = line_is_clear(blocked, starts + 2 * i, ends + 2 * i, samples);
  }
}

}  // namespace explorer
