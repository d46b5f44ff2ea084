// What is unknown behind a frontier.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mr_grid/cells.hpp>

namespace explorer {

struct SightMap {
  mr_grid::Cells<std::int8_t> cells;  // negative where unknown
  const std::uint8_t* enterable;      // nonzero where the robot's centre might come to stand
  std::int8_t occupied_from;
};

// For each of n cells (row, column) what rays from it show: `areas` (n, 2) of the unknown cells that they meet first,
// all of them and those that are enterable, in cells; `depths` (n), in cells, of the third deepest ray. A ray passes up
// to `skipped` known cells before the unknown, ends with it and after `reach` cells; what is off the map is unknown.
void unknown_behind(const SightMap& map, const std::int64_t* starts, std::size_t n, int reach, int skipped,
                    double* areas, double* depths);

}  // namespace explorer
