#include "walls.hpp"

#include <algorithm>
#include <cmath>

#include "obstacles.hpp"

namespace map_merger {

Walls walls_of(const Mask& obstacles, std::int64_t smallest, double largest_mover) {
  const Obstacles found = obstacles_of(obstacles);
  Walls walls;
  for (const Run& run : found.runs) {
    const Obstacle& whole = found.all[run.obstacle];
    if (whole.area < smallest) continue;
    const std::int64_t extent = std::max(whole.bottom - whole.top, whole.right - whole.left);
    for (std::int64_t column = run.left; column < run.right; ++column) {
      walls.cells.push_back({static_cast<int>(run.row), static_cast<int>(column)});
      walls.large.push_back(static_cast<double>(extent) > largest_mover);
    }
  }
  return walls;
}

void clear_discs(std::uint8_t* cells, std::int64_t rows, std::int64_t columns,
                 const std::vector<mr_grid::Cell>& centres, double radius) {
  const auto reach = static_cast<std::int64_t>(radius);
  std::vector<std::int64_t> across;  // by the distance in rows
  for (std::int64_t down = 0; down <= reach; ++down) {
    std::int64_t most = reach;
    while (std::hypot(static_cast<double>(down), static_cast<double>(most)) > radius && most > 0) --most;
    across.push_back(most);
  }
  for (const mr_grid::Cell& centre : centres) {
    for (std::int64_t step = -reach; step <= reach; ++step) {
      const std::int64_t row = centre.row + step, most = across[static_cast<std::size_t>(std::abs(step))];
      if (row < 0 || row >= rows) continue;
      const std::int64_t left = std::max<std::int64_t>(0, centre.column - most);
      const std::int64_t right = std::min(columns, centre.column + most + 1);
      std::fill(cells + row * columns + left, cells + row * columns + right, std::uint8_t{0});
    }
  }
}

}  // namespace map_merger
