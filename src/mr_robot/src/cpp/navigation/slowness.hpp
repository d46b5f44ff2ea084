// What a cell of a map costs to cross: more beside walls, blocked where the robot does not fit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace mr_robot::navigation {

struct Inflation {
  float least;      // m to walls, less than which a cell is blocked
  float most;       // m from which a cell costs 1
  float wall_cost;  // that a cell at `least` costs more
};

float slowness_at(float distance, const Inflation& inflation);

// For each of rows * columns `cells` (above 50 = wall, below 0 = unknown): metres from its centre to that of the
// nearest wall, infinity where that is farther than `inflation.most`, and its slowness. Unknown cells may block, too.
void inflate(const std::int8_t* cells, int rows, int columns, float resolution, const Inflation& inflation,
             bool unknown_blocks, float* distance, float* slowness);

// Makes the cells around those of obstacles, (row, column) inside the grid, slower.
void add_obstacles(float* slowness, int rows, int columns, std::vector<std::pair<int, int>> obstacles, float resolution,
                   const Inflation& inflation);

}  // namespace mr_robot::navigation
