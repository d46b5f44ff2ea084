// An occupancy grid as navigation looks at it.
#pragma once

#include <cstdint>
#include <mr_grid/cells.hpp>

namespace mr_robot::navigation {

using Map = mr_grid::Grid<std::int8_t>;  // below 0 = unknown, above 50 = wall

inline bool is_known(const Map& map, const mr_grid::Point& place) {
  const auto index = map.index_of(place);
  return index && map.values[*index] >= 0;
}

}  // namespace mr_robot::navigation
