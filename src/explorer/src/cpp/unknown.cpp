#include "unknown.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace explorer {
namespace {

constexpr int kDirections = 32;
constexpr double kPi = 3.14159265358979323846;

struct Direction {
  double down, right;
};

struct Behind {
  double area = 0.0, enterable = 0.0, depth = 0.0;
};

std::array<Direction, kDirections> directions() {
  std::array<Direction, kDirections> all;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2.0 * kPi * i / kDirections;
    all[static_cast<std::size_t>(i)] = {std::sin(angle), std::cos(angle)};
  }
  return all;
}

Behind along(const SightMap& map, std::int64_t row, std::int64_t column, const Direction& direction, int reach,
             int skipped) {
  Behind behind;
  for (int step = 1; step <= reach; ++step) {
    const std::int64_t y = row + static_cast<std::int64_t>(std::nearbyint(direction.down * step));
    const std::int64_t x = column + static_cast<std::int64_t>(std::nearbyint(direction.right * step));
    const bool inside = y >= 0 && x >= 0 && y < map.rows && x < map.columns;
    const std::int64_t index = y * map.columns + x;
    if (inside && map.cells[index] >= 0) {
      if (map.cells[index] >= map.occupied_from || behind.depth > 0.0 || step > skipped) break;
      continue;
    }
    const double share = 2.0 * kPi * step / kDirections;
    behind.depth += 1.0;
    behind.area += share;
    if (!inside || map.enterable[index]) behind.enterable += share;
  }
  return behind;
}

}  // namespace

void unknown_behind(const SightMap& map, const std::int64_t* starts, std::size_t n, int reach, int skipped,
                    double* areas, double* depths) {
  static const auto kAll = directions();
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, kDirections> lengths{};
    areas[2 * i] = areas[2 * i + 1] = 0.0;
    for (std::size_t k = 0; k < kAll.size(); ++k) {
      const Behind behind = along(map, starts[2 * i], starts[2 * i + 1], kAll[k], reach, skipped);
      lengths[k] = behind.depth;
      areas[2 * i] += behind.area;
      areas[2 * i + 1] += behind.enterable;
    }
    std::nth_element(lengths.begin(), lengths.begin() + 2, lengths.end(), std::greater<double>());
    depths[i] = lengths[2];
  }
}

}  // namespace explorer
