// From where a point is seen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mr_grid/cells.hpp>

namespace explorer {

// For each of n points (x, y) in metres the index of the place nearest to it into `views`, or -1 if that place is
// farther than `view_distance` or cells that are `blocked` (nonzero) lie between.
// Points are in the order of their `groups`; lines of sight in one group are sampled as `lines_are_clear` does.
// `labels`: for each cell the number, from 1 on, of the nearest place in `places`, indices of cells.
void nearest_views(const mr_grid::Grid<std::int32_t>& labels, const std::int64_t* places,
                   const mr_grid::Grid<std::uint8_t>& blocked, const double* points, const std::int64_t* groups,
                   std::size_t n, double view_distance, std::int64_t* views);

// For each of n points (x, y) in metres the index of the first cell that is `reachable` (nonzero), no
// farther than `view_distance` and in sight, into `views`, or -1; every third one is tried, from near to far. Lines of
// sight to one point are sampled as `lines_are_clear` does.
void search_views(const mr_grid::Grid<std::uint8_t>& reachable, const mr_grid::Grid<std::uint8_t>& blocked,
                  const double* points, std::size_t n, double view_distance, std::int64_t* views);

}  // namespace explorer
