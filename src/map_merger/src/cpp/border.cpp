#include "border.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mask.hpp"

namespace map_merger {
namespace {

constexpr int kReach = 3;            // cells around an obstacle from which the direction of its wall is taken
constexpr double kLineLike = 0.6;    // least anisotropy of a wall
constexpr double kFreeBeside = 1.2;  // cells from an obstacle to where its free side must be free

struct Direction {
  double row = 0.0, column = 0.0;  // unit normal of the wall
  double anisotropy = 0.0;         // 0 .. 1, how line-like it is
};

// How many of seven cells beside one another are obstacles, and the sums of their columns, from -kReach to kReach, and
// of the squares of these.
struct RowSums {
  int count = 0, columns = 0, squares = 0;
};

constexpr int kPatterns = 1 << (2 * kReach + 1);

// By the pattern of the cells, the lowest bit for the column -kReach.
std::array<RowSums, kPatterns> sums_of_patterns() {
  std::array<RowSums, kPatterns> sums{};
  for (int pattern = 0; pattern < kPatterns; ++pattern) {
    for (int column = -kReach; column <= kReach; ++column) {
      if (!(pattern >> (column + kReach) & 1)) continue;
      RowSums& row = sums[static_cast<std::size_t>(pattern)];
      row.count += 1, row.columns += column, row.squares += column * column;
    }
  }
  return sums;
}

// The cells from the column on, which is not below 0, as a pattern; unset beyond the last one.
int pattern_at(const Mask& mask, std::int64_t row, std::int64_t column) {
  const std::uint64_t* words = mask.row(row);
  const std::int64_t word = column >> 6, shift = column & 63;
  std::uint64_t bits = words[word] >> shift;
  if (shift && word + 1 < mask.words()) bits |= words[word + 1] << (64 - shift);
  return static_cast<int>(bits & (kPatterns - 1));
}

// Second moments of the obstacles in the window around a cell, the cell itself among them. The mask has kReach rows and
// columns more than the map on each side.
Direction direction_at(const Mask& mask, const mr_grid::Cell& cell) {
  static const std::array<RowSums, kPatterns> patterns = sums_of_patterns();
  int cells = 0, r = 0, c = 0, rr = 0, cc = 0, rc = 0;
  for (int row = -kReach; row <= kReach; ++row) {
    const int pattern = pattern_at(mask, cell.row + kReach + row, cell.column);
    const RowSums& sums = patterns[static_cast<std::size_t>(pattern)];
    cells += sums.count, r += sums.count * row, rr += sums.count * row * row;
    c += sums.columns, cc += sums.squares, rc += sums.columns * row;
  }
  const double count = cells, mean_row = r / count, mean_column = c / count;
  const double spread_row = rr / count - mean_row * mean_row, spread_column = cc / count - mean_column * mean_column;
  const double mixed = 2.0 * (rc / count - mean_row * mean_column), difference = spread_column - spread_row;
  const double tangent = 0.5 * std::atan2(mixed, difference);
  const double anisotropy =
      std::sqrt(difference * difference + mixed * mixed) / std::max(spread_column + spread_row, 1e-6);
  return {std::cos(tangent), -std::sin(tangent), anisotropy};
}

bool free_beside(const Raster& free, const mr_grid::Cell& cell, double row_step, double column_step) {
  const int row = static_cast<int>(std::nearbyint(cell.row + kFreeBeside * row_step));
  const int column = static_cast<int>(std::nearbyint(cell.column + kFreeBeside * column_step));
  return free.at(std::clamp(row, 0, free.rows - 1), std::clamp(column, 0, free.columns - 1));
}

}  // namespace

std::vector<BorderPoint> border_of(const std::vector<mr_grid::Cell>& cells, const Raster& free) {
  Mask mask(free.rows + 2 * kReach, free.columns + 2 * kReach);
  for (const mr_grid::Cell& cell : cells) {
    const std::int64_t column = cell.column + kReach;
    mask.row(cell.row + kReach)[column >> 6] |= std::uint64_t{1} << (column & 63);
  }
  std::vector<Direction> directions;
  directions.reserve(cells.size());
  for (const mr_grid::Cell& cell : cells) directions.push_back(direction_at(mask, cell));
  const Frame frame(free.origin);
  std::vector<BorderPoint> border;
  for (const double side : {1.0, -1.0}) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double row = side * directions[i].row, column = side * directions[i].column;
      if (directions[i].anisotropy <= kLineLike || !free_beside(free, cells[i], row, column)) continue;
      // The face lies half a cell beside the cell's centre.
      const double x = (cells[i].column + 0.5 * column + 0.5) * free.resolution;
      const double y = (cells[i].row + 0.5 * row + 0.5) * free.resolution;
      border.push_back({frame * OrientedPoint{x, y, column, row}, i});
    }
  }
  return border;
}

}  // namespace map_merger
