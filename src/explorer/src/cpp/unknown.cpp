#include "unknown.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace explorer {
namespace {

constexpr int kDirections = 32;
constexpr double kPi = 3.14159265358979323846;

struct Behind {
  double area = 0.0, enterable = 0.0, depth = 0.0;
};

struct Step {
  std::int64_t down, right;
};

// The cells of a ray, one for each step from the first on.
std::vector<Step> ray(int number, int reach) {
  const double angle = 2.0 * kPi * number / kDirections;
  std::vector<Step> steps;
  for (int step = 1; step <= reach; ++step) {
    steps.push_back({static_cast<std::int64_t>(std::nearbyint(std::sin(angle) * step)),
                     static_cast<std::int64_t>(std::nearbyint(std::cos(angle) * step))});
  }
  return steps;
}

Behind along(const SightMap& map, std::int64_t row, std::int64_t column, const std::vector<Step>& steps, int skipped) {
  Behind behind;
  bool open = true;
  for (int step = 1; step <= static_cast<int>(steps.size()); ++step) {
    const Step& there = steps[static_cast<std::size_t>(step) - 1];
    const std::int64_t y = row + there.down, x = column + there.right;
    const bool inside = map.cells.contains(y, x);
    if (inside && map.cells.at(y, x) >= 0) {
      if (map.cells.at(y, x) >= map.occupied_from || behind.depth > 0.0 || step > skipped) break;
      continue;
    }
    const double share = 2.0 * kPi * step / kDirections;
    behind.depth += 1.0;
    behind.area += share;
    if (inside) open = map.enterable[map.cells.index(y, x)];
    if (open) behind.enterable += share;
  }
  return behind;
}

}  // namespace

void unknown_behind(const SightMap& map, const std::int64_t* starts, std::size_t n, int reach, int skipped,
                    double* areas, double* depths) {
  std::vector<std::vector<Step>> rays;
  for (int number = 0; number < kDirections; ++number) rays.push_back(ray(number, reach));
  for (std::size_t i = 0; i < n; ++i) {
    std::array<double, kDirections> lengths{};
    areas[2 * i] = areas[2 * i + 1] = 0.0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const Behind behind = along(map, starts[2 * i], starts[2 * i + 1], rays[k], skipped);
      lengths[k] = behind.depth;
      areas[2 * i] += behind.area;
      areas[2 * i + 1] += behind.enterable;
    }
    std::nth_element(lengths.begin(), lengths.begin() + 2, lengths.end(), std::greater<double>());
    depths[i] = lengths[2];
  }
}

}  // namespace explorer
