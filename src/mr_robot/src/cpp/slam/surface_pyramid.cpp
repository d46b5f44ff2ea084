#include "surface_pyramid.hpp"

namespace mr_robot::slam {
namespace {

constexpr int kMapCells = 2;  // of the map along a side of a cell
constexpr int kFacings = 8;   // directions
constexpr double kEighth = 2.0 * M_PI / kFacings;

std::uint8_t bit(long direction) { return static_cast<std::uint8_t>(1U << (direction & (kFacings - 1))); }

int cells_of(int map_cells) { return (map_cells + kMapCells - 1) / kMapCells; }

}  // namespace

std::uint8_t facings_of_surface(const Point& normal) {
  const auto below = static_cast<long>(std::floor(std::atan2(normal.y, normal.x) / kEighth));
  return static_cast<std::uint8_t>(bit(below) | bit(below + 1));
}

std::uint8_t facing_of_hit(const Point& normal) { return bit(std::lround(std::atan2(normal.y, normal.x) / kEighth)); }

SurfacePyramid::SurfacePyramid(const GridMap& map)
    : cell_(kMapCells * map.resolution()),
      width_(cells_of(map.width())),
      height_(cells_of(map.height())),
      corner_{map.origin().x * map.resolution(), map.origin().y * map.resolution()} {}

// A hit up to a cell of the map beside a surface is on it.
void SurfacePyramid::mark(const GridMap& map) {
  std::vector<std::uint8_t>& cells = levels_.emplace_back(static_cast<std::size_t>(width_) * height_);
  const Cell low = map.origin(), high{low.x + map.width() - 1, low.y + map.height() - 1};
  map.visit_marked(low, high, [&](const Cell& cell) {
    const Surface& surface = *map.surface(cell);
    const std::uint8_t facings = facings_of_surface({surface.normal_x, surface.normal_y});
    const int left = std::max(cell.x - low.x - 1, 0) / kMapCells, bottom = std::max(cell.y - low.y - 1, 0) / kMapCells;
    const int right = std::min((cell.x - low.x + 1) / kMapCells, width_ - 1);
    const int top = std::min((cell.y - low.y + 1) / kMapCells, height_ - 1);
    for (int y = bottom; y <= top; ++y) {
      for (int x = left; x <= right; ++x) cells[static_cast<std::size_t>(y) * width_ + x] |= facings;
    }
  });
}

bool SurfacePyramid::grow(const GridMap& map) {
  if (levels_.empty()) {
    mark(map);
    return false;
  }
  const int below = static_cast<int>(levels_.size()) - 1, half = 1 << below, margin = 2 * half - 1;
  std::vector<std::uint8_t> cells(static_cast<std::size_t>(width_ + margin) * (height_ + margin));
  std::uint8_t* cell = cells.data();
  for (int y = -margin; y < height_; ++y) {
    for (int x = -margin; x < width_; ++x) {
      *cell++ = facings(below, x, y) | facings(below, x + half, y) | facings(below, x, y + half) |
                facings(below, x + half, y + half);
    }
  }
  levels_.push_back(std::move(cells));
  return levels_.size() == kLevels;
}

}  // namespace mr_robot::slam
