// An occupancy grid as navigation looks at it.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace mr_robot::navigation {

struct Map {
  const std::int8_t* cells;  // below 0 = unknown, above 50 = wall
  int rows, columns;
  double resolution, origin_x, origin_y;  // m
};

// Index of the cell that a place, m, lies in; nothing outside the map.
inline std::optional<std::size_t> cell_of(const Map& map, double x, double y) {
  const double column = std::floor((x - map.origin_x) / map.resolution);
  const double row = std::floor((y - map.origin_y) / map.resolution);
  if (!(row >= 0.0 && column >= 0.0 && row < map.rows && column < map.columns)) return std::nullopt;
  return static_cast<std::size_t>(row) * map.columns + static_cast<std::size_t>(column);
}

inline bool is_known(const Map& map, double x, double y) {
  const auto cell = cell_of(map, x, y);
  return cell && map.cells[*cell] >= 0;
}

}  // namespace mr_robot::navigation
