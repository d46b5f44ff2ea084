// The surfaces of a map for the search of places on it: which ways they face, in cells and in larger and larger squares
// of them.
#pragma once

#include <cstdint>
#include <vector>

#include "grid_map.hpp"

namespace mr_robot::slam {

// Two of the eight directions, one bit each, that a surface with this normal may be seen to face, or the one that a hit
// does. They share one wherever the normals are within a sixteenth of a turn of each other.
std::uint8_t facings_of_surface(const Point& normal);
std::uint8_t facing_of_hit(const Point& normal);

class SurfacePyramid {
 public:
  static constexpr int kLevels = 6;  // squares of 1, 2, ... 32 cells along a side

  // Of a map's resolution (m), twice which is its own. It has no level until `grow` has made them.
  explicit SurfacePyramid(const GridMap& map);
  // The next level; returns whether that was the last one.
  bool grow(const GridMap& map);

  double cell() const { return cell_; }  // m
  int width() const { return width_; }
  int height() const { return height_; }
  // m, map frame: the lower left corner.
  const Point& corner() const { return corner_; }
  // Ways that surfaces face in the square whose lower left cell that is; 0 where there are none.
  std::uint8_t facings(int level, int column, int row) const {
    const int margin = (1 << level) - 1;  // a square may begin left of the map or below it
    const int x = column + margin, y = row + margin, stride = width_ + margin;
    if (x < 0 || y < 0 || column >= width_ || row >= height_) return 0;
    return levels_[level][static_cast<std::size_t>(y) * stride + x];
  }

 private:
  void mark(const GridMap& map);

  double cell_;
  int width_, height_;
  Point corner_;
  std::vector<std::vector<std::uint8_t>> levels_;
};

}  // namespace mr_robot::slam
