#include "march.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace mr_sim::navigation {
namespace {

struct Front {
  float cost;
  int index;
  bool operator<(const Front& other) const { return cost > other.cost; }
};

// Upwind solution of (T - a)^2 + (T - b)^2 = f^2 with the lesser neighbours a, b of each axis.
float solve(float a, float b, float f) {
  if (a > b) std::swap(a, b);
  if (b - a >= f) return a + f;
  return 0.5F * (a + b + std::sqrt(2.0F * f * f - (a - b) * (a - b)));
}

}  // namespace

std::vector<float> march(const float* slowness, int rows, int columns, const std::vector<Seed>& seeds, int stop_row,
                         int stop_column, float beyond, float limit) {
  std::vector<float> cost(static_cast<std::size_t>(rows) * columns, kUnreached);
  std::vector<uint8_t> fixed(cost.size(), 0);
  std::priority_queue<Front> front;
  for (const Seed& seed : seeds) {
    const int index = seed.row * columns + seed.column;
    if (!std::isfinite(slowness[index]) || seed.cost >= cost[index]) continue;
    cost[index] = seed.cost;
    front.push({seed.cost, index});
  }
  const int stop = stop_row < 0 ? -1 : stop_row * columns + stop_column;
  const auto value = [&](int row, int column) {
    if (row < 0 || column < 0 || row >= rows || column >= columns) return kUnreached;
    return fixed[row * columns + column] ? cost[row * columns + column] : kUnreached;
  };
  while (!front.empty()) {
    const Front top = front.top();
    front.pop();
    if (fixed[top.index]) continue;
    if (top.cost > limit) break;
    fixed[top.index] = 1;
    if (top.index == stop) limit = std::min(limit, top.cost + beyond);
    const int row = top.index / columns, column = top.index % columns;
    for (const auto& [r, c] : {std::pair{row - 1, column}, {row + 1, column}, {row, column - 1}, {row, column + 1}}) {
      if (r < 0 || c < 0 || r >= rows || c >= columns) continue;
      const int index = r * columns + c;
      if (fixed[index] || !std::isfinite(slowness[index])) continue;
      const float candidate = solve(std::min(value(r - 1, c), value(r + 1, c)),
                                    std::min(value(r, c - 1), value(r, c + 1)), slowness[index]);
      if (candidate < cost[index]) {
        cost[index] = candidate;
        front.push({candidate, index});
      }
    }
  }
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (!fixed[i]) cost[i] = kUnreached;
  }
  return cost;
}

}  // namespace mr_sim::navigation
