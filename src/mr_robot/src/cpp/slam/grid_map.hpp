// The map: an occupancy grid, and per occupied cell the surface seen in it with sub-cell accuracy.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "scan.hpp"
#include "surfaces.hpp"

namespace mr_robot::slam {

struct Cell {
  int x = 0, y = 0;  // index on the lattice whose cell (0, 0) has its lower left corner at the map's origin
};

struct GridOptions {
  double free_radius;            // m around the robot that is free because the robot is there
  double small_object_size;      // m from end to end, up to which what stands alone may be a robot
  double resolution = 0.05;      // m
  double occupied_step = 1.2;    // log-odds of one hit
  double free_step = 0.5;        // log-odds of one beam through
  double certainty_limit = 3.6;  // log-odds, both ways: how soon a map gives in to new evidence
};

class GridMap {
 public:
  explicit GridMap(const GridOptions& options);

  struct Disc {
    Pose centre;
    double radius;  // m
  };
  // Both make it so large that it need not grow step by step: as another one, or to hold all discs.
  void cover(const GridMap& other);
  void cover(const std::vector<Disc>& discs);
  // Both return whether `occupancy` changed. `origin`: what its new surfaces are known by.
  bool insert(const Scan& scan, const Pose& robot, int origin = 0);
  // Only the surfaces that the scan hits, and nothing of what it sees through.
  void add_hits(const Scan& scan, const Pose& robot, int origin);
  // Takes from the map what the scan sees through, and adds nothing.
  bool clear(const Scan& scan, const Pose& robot);

  int width() const { return width_; }
  int height() const { return height_; }
  Cell origin() const { return origin_; }
  double resolution() const { return options_.resolution; }

  Cell cell_of(const Point& point) const;
  // The surface in a cell of the lattice, or nullptr where there is none.
  const Surface* surface(const Cell& cell) const;
  // Calls visit(surface) for each surface of the cells from `low` to `high`, both included, row by row.
  template <class Visit>
  void visit_surfaces(const Cell& low, const Cell& high, Visit visit) const;
  // The same with visit(cell) for each of these cells that has a surface.
  template <class Visit>
  void visit_marked(const Cell& low, const Cell& high, Visit visit) const;

  // Whether the cell and those around it have been seen: a wall in it that is not on the map would be new.
  bool known(const Cell& cell) const;
  // Whether something was hit there or beside it, too far away or too scattered to be a surface.
  bool hit_beside(const Cell& cell) const;
  // Whether a surface of the map lies across the line, well before its end. A small one that stands alone says nothing:
  // a robot that stood close by, and has left, hid as much as a wall.
  bool blocked(const Point& eye, const Point& end) const;

  // m of beams that have been drawn: what that has cost.
  double walked() const { return walked_; }

  // 100 occupied, 0 free, -1 never seen; row-major from the lowest y.
  std::vector<int8_t> occupancy() const;

 private:
  struct Ray {
    Point eye, end;   // m, map frame
    Point direction;  // unit vector
  };

  bool contains(const Cell& cell) const;
  std::size_t index_of(const Cell& cell) const;
  const Surface& surface_of(const Cell& cell) const { return surfaces_(cell.x - origin_.x, cell.y - origin_.y); }
  Surface& surface_of(const Cell& cell) { return surfaces_.at(cell.x - origin_.x, cell.y - origin_.y); }
  bool has_surface(const Cell& cell) const;
  bool occupied(const Cell& cell) const;
  void mark_surface(const Cell& cell);
  void grow_to(Cell low, Cell high);
  void change_odds(const Cell& cell, int step);
  void begin_scan(const Scan& scan, const Pose& robot);
  // Whether it is the first of the scan in its cell.
  bool touch(const Cell& cell);
  void add_hit(const Beam& beam, const Frame& robot);
  void add_to_surface(Surface& surface, const Point& end, const Point& normal, bool first_of_scan) const;
  void see_through(const Point& eye, const Point& end);
  // Calls visit(cell) for the cells of a line, from its beginning, until it returns false.
  template <class Visit>
  void walk(const Ray& ray, double length, Visit visit) const;
  bool sees_through(const Surface& surface, const Ray& ray) const;
  // Whether the surface in a cell and those around it, one beside the other, are small enough for what moves.
  bool stands_alone(const Cell& cell) const;
  void free_cell(const Cell& cell, const Ray& ray);
  void free_footprint(const Pose& robot, const Point& eye);  // `eye`: the laser, robot's frame

  GridOptions options_;
  int occupied_step_, free_step_, odds_limit_;  // in the steps of `odds_`
  // Of each cell, in arrays of their own: beams pass many cells, and of most they need but a part of this.
  std::vector<int8_t> odds_;  // log-odds of being free, in steps of 1/16
  Surfaces surfaces_;
  std::vector<uint8_t> seen_;
  // Twice the number of the last scan that saw through the cell, and one more if the scan hit it.
  std::vector<uint32_t> touched_;
  // One bit for each cell that has a surface, `words_` words to a row: most cells have none, and looking for surfaces
  // is most of the work of matching.
  std::vector<uint64_t> marks_;
  int words_ = 0;
  Cell origin_;
  int width_ = 0, height_ = 0;
  uint32_t scan_number_ = 0;
  int inserted_origin_ = 0;
  bool changed_ = false;  // by the last scan
  double walked_ = 0.0;   // m
};

template <class Visit>
void GridMap::visit_surfaces(const Cell& low, const Cell& high, Visit visit) const {
  visit_marked(low, high, [&](const Cell& cell) { visit(surface_of(cell)); });
}

template <class Visit>
void GridMap::visit_marked(const Cell& low, const Cell& high, Visit visit) const {
  const int left = std::max(low.x - origin_.x, 0), right = std::min(high.x - origin_.x, width_ - 1);
  const int bottom = std::max(low.y - origin_.y, 0), top = std::min(high.y - origin_.y, height_ - 1);
  if (left > right) return;
  for (int row = bottom; row <= top; ++row) {
    for (int word = left / 64; word <= right / 64; ++word) {
      uint64_t bits = marks_[static_cast<std::size_t>(row) * words_ + word];
      if (word == left / 64) bits &= ~uint64_t{0} << (left % 64);
      if (word == right / 64) bits &= ~uint64_t{0} >> (63 - right % 64);
      for (; bits != 0; bits &= bits - 1) {
        visit(Cell{word * 64 + __builtin_ctzll(bits) + origin_.x, row + origin_.y});
      }
    }
  }
}

}  // namespace mr_robot::slam
