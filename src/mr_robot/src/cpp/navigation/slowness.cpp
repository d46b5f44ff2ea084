#include "slowness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mr_robot::navigation {
namespace {

// Cells from a wall to where it makes no difference.
int reach_of(const Inflation& inflation, float resolution) {
  return static_cast<int>(std::ceil(inflation.most / resolution));
}

// Cells along the column to the nearest wall, `most` if there is none so near.
std::vector<float> column_distances(const std::int8_t* cells, int rows, int columns, float most) {
  const std::size_t width = columns;
  std::vector<float> distance(rows * width);
  for (std::size_t i = 0; i < distance.size(); ++i) distance[i] = cells[i] > 50 ? 0.0F : most;
  const auto pass = [&](float* row, const float* before) {
    for (std::size_t c = 0; c < width; ++c) row[c] = std::min(row[c], before[c] + 1.0F);
  };
  for (int r = 1; r < rows; ++r) pass(&distance[r * width], &distance[(r - 1) * width]);
  for (int r = rows - 2; r >= 0; --r) pass(&distance[r * width], &distance[(r + 1) * width]);
  return distance;
}

// Squared distances in cells to the nearest wall, exact up to `reach` cells and larger than that beyond.
std::vector<float> squared_distances(const std::int8_t* cells, int rows, int columns, int reach) {
  std::vector<float> along = column_distances(cells, rows, columns, reach + 1.0F);
  for (float& value : along) value *= value;
  std::vector<float> squared = along;
  for (int offset = 1; offset <= std::min(reach, columns - 1); ++offset) {
    const float add = static_cast<float>(offset) * offset;
    const std::size_t count = columns - offset;
    for (int r = 0; r < rows; ++r) {
      const float* from = &along[static_cast<std::size_t>(r) * columns];
      float* to = &squared[static_cast<std::size_t>(r) * columns];
      for (std::size_t c = 0; c < count; ++c) to[c] = std::min(to[c], from[c + offset] + add);
      for (std::size_t c = 0; c < count; ++c) to[c + offset] = std::min(to[c + offset], from[c] + add);
    }
  }
  return squared;
}

}  // namespace

float slowness_at(float distance, const Inflation& inflation) {
  if (distance < inflation.least) return std::numeric_limits<float>::infinity();
  const float near = std::clamp((inflation.most - distance) / (inflation.most - inflation.least), 0.0F, 1.0F);
  return 1.0F + inflation.wall_cost * near * near;
}

void inflate(const std::int8_t* cells, int rows, int columns, float resolution, const Inflation& inflation,
             bool unknown_blocks, float* distance, float* slowness) {
  const int reach = reach_of(inflation, resolution), most = reach * reach;
  std::vector<float> metres, costs;  // by the squared distance in cells
  for (int squared = 0; squared <= most; ++squared) {
    metres.push_back(std::sqrt(static_cast<float>(squared)) * resolution);
    costs.push_back(slowness_at(metres.back(), inflation));
  }
  metres.push_back(std::numeric_limits<float>::infinity());
  costs.push_back(1.0F);
  const std::vector<float> squared = squared_distances(cells, rows, columns, reach);
  for (std::size_t i = 0; i < squared.size(); ++i) {
    const int index = static_cast<int>(std::min(squared[i], most + 1.0F));
    distance[i] = metres[index];
    slowness[i] = unknown_blocks && cells[i] < 0 ? std::numeric_limits<float>::infinity() : costs[index];
  }
}

void add_obstacles(float* slowness, int rows, int columns, std::vector<std::pair<int, int>> obstacles, float resolution,
                   const Inflation& inflation) {
  std::sort(obstacles.begin(), obstacles.end());
  obstacles.erase(std::unique(obstacles.begin(), obstacles.end()), obstacles.end());
  const int reach = reach_of(inflation, resolution), width = 2 * reach + 1;
  std::vector<float> stamp;
  for (int r = -reach; r <= reach; ++r) {
    for (int c = -reach; c <= reach; ++c) {
      stamp.push_back(slowness_at(std::sqrt(static_cast<float>(r * r + c * c)) * resolution, inflation));
    }
  }
  for (const auto& [row, column] : obstacles) {
    const int left = std::max(0, column - reach), right = std::min(columns - 1, column + reach);
    for (int r = std::max(0, row - reach); r <= std::min(rows - 1, row + reach); ++r) {
      const float* from = &stamp[static_cast<std::size_t>(r - row + reach) * width - column + reach];
      float* to = slowness + static_cast<std::size_t>(r) * columns;
      for (int c = left; c <= right; ++c) to[c] = std::max(to[c], from[c]);
    }
  }
}

}  // namespace mr_robot::navigation
