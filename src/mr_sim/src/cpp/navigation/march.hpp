// Fast marching over a grid: the cost to go from every cell to the nearest of some seeds.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

namespace mr_sim::navigation {

constexpr float kUnreached = std::numeric_limits<float>::infinity();

struct Seed {
  int row, column;
  float cost;
};

// Solves |grad T| = slowness (Sethian, A fast marching level set method for monotonically advancing fronts, 1996).
// `slowness`: rows * columns, per cell; infinity = blocked. Cells beyond `limit` stay unreached; once the cell
// (stop_row, stop_column) is reached the limit becomes its cost plus `beyond`. No stop cell: stop_row < 0.
// Returns T in cells, kUnreached where the front did not come.
std::vector<float> march(const float* slowness, int rows, int columns, const std::vector<Seed>& seeds, int stop_row,
                         int stop_column, float beyond, float limit);

}  // namespace mr_sim::navigation
