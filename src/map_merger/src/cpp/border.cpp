#include "border.hpp"

#include <algorithm>
#include <cmath>

namespace map_merger {
namespace {

constexpr int kReach = 3;            // cells around an obstacle from which the direction of its wall is taken
constexpr double kLineLike = 0.6;    // least anisotropy of a wall
constexpr double kFreeBeside = 1.2;  // cells from an obstacle to where its free side must be free

struct Direction {
  double row = 0.0, column = 0.0;  // unit normal of the wall
  double anisotropy = 0.0;         // 0 .. 1, how line-like it is
};

// Second moments of the obstacles in the window around a cell, the cell itself among them.
Direction direction_at(const std::vector<std::uint8_t>& mask, std::size_t stride, std::size_t centre) {
  int cells = 0, r = 0, c = 0, rr = 0, cc = 0, rc = 0;
  for (int row = -kReach; row <= kReach; ++row) {
    const std::uint8_t* cell = &mask[centre + row * static_cast<std::ptrdiff_t>(stride)];
    int in_row = 0, sum = 0, squares = 0;
    for (int column = -kReach; column <= kReach; ++column) {
      in_row += cell[column], sum += cell[column] * column, squares += cell[column] * column * column;
    }
    cells += in_row, r += in_row * row, rr += in_row * row * row, c += sum, cc += squares, rc += sum * row;
  }
  const double count = cells, mean_row = r / count, mean_column = c / count;
  const double spread_row = rr / count - mean_row * mean_row, spread_column = cc / count - mean_column * mean_column;
  const double mixed = 2.0 * (rc / count - mean_row * mean_column), difference = spread_column - spread_row;
  const double tangent = 0.5 * std::atan2(mixed, difference);
  const double anisotropy = std::hypot(difference, mixed) / std::max(spread_column + spread_row, 1e-6);
  return {std::cos(tangent), -std::sin(tangent), anisotropy};
}

bool free_beside(const Raster& free, const ObstacleCell& cell, double row_step, double column_step) {
  const int row = static_cast<int>(std::nearbyint(cell.row + kFreeBeside * row_step));
  const int column = static_cast<int>(std::nearbyint(cell.column + kFreeBeside * column_step));
  return free.at(std::clamp(row, 0, free.rows - 1), std::clamp(column, 0, free.columns - 1));
}

}  // namespace

std::vector<BorderPoint> border_of(const std::vector<ObstacleCell>& cells, const Raster& free) {
  const std::size_t stride = free.columns + 2 * kReach;
  std::vector<std::uint8_t> mask((free.rows + 2 * kReach) * stride);
  const auto at = [&](const ObstacleCell& cell) { return (cell.row + kReach) * stride + cell.column + kReach; };
  for (const ObstacleCell& cell : cells) mask[at(cell)] = 1;
  std::vector<Direction> directions;
  directions.reserve(cells.size());
  for (const ObstacleCell& cell : cells) directions.push_back(direction_at(mask, stride, at(cell)));
  std::vector<BorderPoint> border;
  for (const double side : {1.0, -1.0}) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double row = side * directions[i].row, column = side * directions[i].column;
      if (directions[i].anisotropy <= kLineLike || !free_beside(free, cells[i], row, column)) continue;
      // The face lies half a cell beside the cell's centre.
      const double x = (cells[i].column + 0.5 * column + 0.5) * free.resolution;
      const double y = (cells[i].row + 0.5 * row + 0.5) * free.resolution;
      border.push_back({free.origin * OrientedPoint{x, y, column, row}, i});
    }
  }
  return border;
}

}  // namespace map_merger
