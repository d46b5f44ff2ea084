// Fast marching over a grid: the cost to go from every cell to the nearest of some seeds.
#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace mr_robot::navigation {

constexpr float kUnreached = std::numeric_limits<float>::infinity();

struct Seed {
  int row, column;
  float cost;
};

// An earlier march over a grid of the same size from the same seeds. Of its costs those stay that no change of the
// slowness can reach; without any the march begins at the seeds.
struct Former {
  const float* slowness = nullptr;  // rows * columns
  const float* cost = nullptr;      // rows * columns
};

// Where a march ends: beyond `limit`, or, once the cell (row, column) is reached, beyond its cost plus `beyond`.
struct Stop {
  int row = -1, column = -1;  // no such cell: row < 0
  float beyond = 0.0F;
  float limit = kUnreached;
};

// Solves |grad T| = slowness (Sethian, A fast marching level set method for monotonically advancing fronts, 1996).
// `slowness`: rows * columns, per cell; infinity = blocked.
// Writes T in cells to `result`, kUnreached where the front did not come.
void march(const float* slowness, int rows, int columns, const std::vector<Seed>& seeds, const Stop& stop,
           const Former& former, float* result);

// Cells from (row, column) down the cost to go, each the cheapest of the eight around the one before it; at most
// `most`.
std::vector<std::pair<int, int>> descend(const float* cost, int rows, int columns, int row, int column, int most);

}  // namespace mr_robot::navigation
