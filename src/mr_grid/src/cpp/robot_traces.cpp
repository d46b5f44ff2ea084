#include "robot_traces.hpp"

#include <algorithm>
#include <cmath>

namespace mr_grid {
namespace {

// Where obstacles that may be a robot lie wholly: one cut off at the edge is too large or too far away.
struct Window {
  int top, left, bottom, right;  // without the last two

  int width() const { return std::max(0, right - left); }
  int height() const { return std::max(0, bottom - top); }
};

// Takes the obstacles of a window one by one, each of cells that hang together (8 neighbours).
class Obstacles {
 public:
  Obstacles(const OccupancyGrid& grid, const Window& window)
      : grid_(grid), window_(window), taken_(static_cast<std::size_t>(window.width()) * window.height()) {}

  // The cells of the obstacle that has this one; none where there is none, or when it was taken before.
  const std::vector<Cell>& take(int row, int column) {
    cells_.clear();
    reach(row, column);
    for (std::size_t next = 0; next < cells_.size(); ++next) {
      const Cell cell = cells_[next];
      for (int r = cell.row - 1; r <= cell.row + 1; ++r) {
        for (int c = cell.column - 1; c <= cell.column + 1; ++c) reach(r, c);
      }
    }
    return cells_;
  }

 private:
  void reach(int row, int column) {
    if (row < window_.top || row >= window_.bottom || column < window_.left || column >= window_.right) return;
    if (!grid_.occupied(row, column)) return;
    std::uint8_t& taken = taken_[static_cast<std::size_t>(row - window_.top) * window_.width() + column - window_.left];
    if (taken == 0) cells_.push_back({row, column});
    taken = 1;
  }

  const OccupancyGrid& grid_;
  Window window_;
  std::vector<std::uint8_t> taken_;
  std::vector<Cell> cells_;
};

bool is_robot(const std::vector<Cell>& cells, const OccupancyGrid& grid, const Point& place, double most_apart,
              double largest) {
  if (cells.empty()) return false;
  Cell low = cells.front(), high = low;
  double rows = 0.0, columns = 0.0;
  for (const Cell& cell : cells) {
    low = {std::min(low.row, cell.row), std::min(low.column, cell.column)};
    high = {std::max(high.row, cell.row), std::max(high.column, cell.column)};
    rows += cell.row;
    columns += cell.column;
  }
  const int extent = std::max(high.row - low.row, high.column - low.column) + 1;
  if (extent * grid.resolution > largest + 1e-9) return false;
  const double count = static_cast<double>(cells.size());
  const double x = grid.origin.x + (columns / count + 0.5) * grid.resolution;
  const double y = grid.origin.y + (rows / count + 0.5) * grid.resolution;
  return std::hypot(x - place.x, y - place.y) <= most_apart;
}

Window around(const Point& place, const OccupancyGrid& grid, int reach) {
  // Bounded before it becomes an integer: a place may be anywhere, and nowhere.
  const auto cell = [&](double along, double from, int count) {
    const double least = -1.0 - reach, most = 1.0 * count + reach,
                 number = std::floor((along - from) / grid.resolution);
    return static_cast<int>(std::isnan(number) ? least : std::clamp(number, least, most));
  };
  const int row = cell(place.y, grid.origin.y, grid.rows);
  const int column = cell(place.x, grid.origin.x, grid.columns);
  return {std::max(0, row - reach), std::max(0, column - reach), std::min(grid.rows, row + reach + 1),
          std::min(grid.columns, column + reach + 1)};
}

}  // namespace

std::vector<Cell> robot_traces(const OccupancyGrid& grid, const std::vector<Point>& places, double most_apart,
                               double largest) {
  const int reach = static_cast<int>((most_apart + largest) / grid.resolution) + 2;
  std::vector<Cell> found;
  for (const Point& place : places) {
    const Window window = around(place, grid, reach);
    Obstacles obstacles(grid, window);
    for (int row = window.top; row < window.bottom; ++row) {
      for (int column = window.left; column < window.right; ++column) {
        if (!grid.occupied(row, column)) continue;
        const std::vector<Cell>& obstacle = obstacles.take(row, column);
        if (is_robot(obstacle, grid, place, most_apart, largest)) {
          found.insert(found.end(), obstacle.begin(), obstacle.end());
        }
      }
    }
  }
  return found;
}

}  // namespace mr_grid
