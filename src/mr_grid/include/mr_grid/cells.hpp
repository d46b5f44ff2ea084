// Occupancy grids whose cells somebody else keeps.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pose.hpp"

namespace mr_grid {

struct Cell {
  int row, column;
};

// Row by row.
template <typename Value>
struct Cells {
  const Value* values;
  int rows, columns;

  std::size_t count() const { return static_cast<std::size_t>(rows) * columns; }
  bool contains(std::int64_t row, std::int64_t column) const {
    return row >= 0 && column >= 0 && row < rows && column < columns;
  }
  std::int64_t index(std::int64_t row, std::int64_t column) const { return row * columns + column; }
  const Value& at(std::int64_t row, std::int64_t column) const { return values[index(row, column)]; }
};

// Cells along the axes of a frame.
template <typename Value>
struct Grid : Cells<Value> {
  double resolution;  // m
  Point origin;       // m, the corner of cell (0, 0)

  Point middle_of(std::int64_t row, std::int64_t column) const {
    return {origin.x + (static_cast<double>(column) + 0.5) * resolution,
            origin.y + (static_cast<double>(row) + 0.5) * resolution};
  }

  // Index of the cell that a place, m, lies in; nothing off the grid.
  std::optional<std::int64_t> index_of(const Point& place) const {
    const double column = std::floor((place.x - origin.x) / resolution);
    const double row = std::floor((place.y - origin.y) / resolution);
    // Compared before they become integers: a place may be anywhere, and nowhere.
    if (!(row >= 0.0 && column >= 0.0 && row < this->rows && column < this->columns)) return std::nullopt;
    return this->index(static_cast<std::int64_t>(row), static_cast<std::int64_t>(column));
  }
};

}  // namespace mr_grid
