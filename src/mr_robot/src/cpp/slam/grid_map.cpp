#include "grid_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mr_robot::slam {
namespace {

constexpr int kBlock = Surfaces::kBlock;  // the grid grows by whole blocks of cells
constexpr float kMemory = 60.0F;          // hits after which a surface is a running mean
constexpr double kSurfaceReach = 0.02;    // m, a beam passing a surface this near has seen through it
constexpr double kBehind = 0.1;           // m, and it must end this far behind it
constexpr int kGap = 2;                   // cells from one to the next of a surface: one may lie between them
constexpr double kStripShare = 0.5;       // of the radius that is free: half the width of the strip out to the laser

int block_floor(int value) { return static_cast<int>(std::floor(static_cast<double>(value) / kBlock)) * kBlock; }

}  // namespace

GridMap::GridMap(const GridOptions& options)
    : options_(options),
      occupied_step_(static_cast<int>(std::lround(16.0 * options.occupied_step))),
      free_step_(static_cast<int>(std::lround(16.0 * options.free_step))),
      odds_limit_(std::min(127, static_cast<int>(16.0 * options.certainty_limit))) {}

Cell GridMap::cell_of(const Point& point) const {
  return {static_cast<int>(std::floor(point.x / options_.resolution)),
          static_cast<int>(std::floor(point.y / options_.resolution))};
}

bool GridMap::contains(const Cell& cell) const {
  return cell.x >= origin_.x && cell.y >= origin_.y && cell.x < origin_.x + width_ && cell.y < origin_.y + height_;
}

const Surface* GridMap::surface(const Cell& cell) const {
  if (!contains(cell)) return nullptr;
  return has_surface(cell) ? &surface_of(cell) : nullptr;
}

std::size_t GridMap::index_of(const Cell& cell) const {
  return static_cast<std::size_t>(cell.y - origin_.y) * width_ + cell.x - origin_.x;
}

void GridMap::grow_to(Cell low, Cell high) {
  if (width_ > 0) {
    if (contains(low) && contains(high)) return;
    low = {std::min(low.x, origin_.x), std::min(low.y, origin_.y)};
    high = {std::max(high.x, origin_.x + width_ - 1), std::max(high.y, origin_.y + height_ - 1)};
  }
  low = {block_floor(low.x), block_floor(low.y)};
  high = {block_floor(high.x) + kBlock, block_floor(high.y) + kBlock};
  const int width = high.x - low.x, height = high.y - low.y;
  const auto move_cells = [&](auto& cells) {
    std::decay_t<decltype(cells)> moved(static_cast<std::size_t>(width) * height);
    for (int row = 0; row < height_; ++row) {
      std::copy_n(&cells[static_cast<std::size_t>(row) * width_], width_,
                  &moved[static_cast<std::size_t>(row + origin_.y - low.y) * width + origin_.x - low.x]);
    }
    cells = std::move(moved);
  };
  move_cells(odds_);
  move_cells(seen_);
  surfaces_.resize(width / kBlock, height / kBlock, (origin_.x - low.x) / kBlock, (origin_.y - low.y) / kBlock);
  touched_.assign(seen_.size(), 0);  // maps grow between two scans
  origin_ = low;
  width_ = width;
  height_ = height;
  words_ = (width + 63) / 64;
  marks_.assign(static_cast<std::size_t>(words_) * height, 0);
  for (int y = low.y; y < low.y + height; ++y) {
    for (int x = low.x; x < low.x + width; x += kBlock) {
      if (!surfaces_.holds(x - low.x, y - low.y)) continue;
      for (int along = 0; along < kBlock; ++along) mark_surface({x + along, y});
    }
  }
}

void GridMap::cover(const std::vector<Disc>& discs) {
  if (discs.empty()) return;
  Point low{discs[0].centre.x, discs[0].centre.y}, high = low;
  for (const auto& [centre, radius] : discs) {
    low = {std::min(low.x, centre.x - radius), std::min(low.y, centre.y - radius)};
    high = {std::max(high.x, centre.x + radius), std::max(high.y, centre.y + radius)};
  }
  grow_to(cell_of(low), cell_of(high));
}

void GridMap::cover(const GridMap& other) {
  if (other.width_ == 0) return;
  grow_to(other.origin_, {other.origin_.x + other.width_ - 1, other.origin_.y + other.height_ - 1});
}

bool GridMap::has_surface(const Cell& cell) const {
  const int column = cell.x - origin_.x;
  return marks_[static_cast<std::size_t>(cell.y - origin_.y) * words_ + column / 64] >> (column % 64) & 1;
}

// To be called after each change of a cell's surface.
void GridMap::mark_surface(const Cell& cell) {
  const int column = cell.x - origin_.x;
  uint64_t& word = marks_[static_cast<std::size_t>(cell.y - origin_.y) * words_ + column / 64];
  const uint64_t mark = uint64_t{1} << (column % 64);
  word = std::as_const(*this).surface_of(cell).hits > 0.0F ? word | mark : word & ~mark;
}

// `step`: added to the log-odds of being occupied.
void GridMap::change_odds(const Cell& cell, int step) {
  int8_t& odds = odds_[index_of(cell)];
  uint8_t& seen = seen_[index_of(cell)];
  const bool was_occupied = odds < 0;
  odds = static_cast<int8_t>(std::clamp(odds - step, -odds_limit_, odds_limit_));
  changed_ |= !seen || was_occupied != (odds < 0);
  seen = 1;
}

void GridMap::begin_scan(const Scan& scan, const Pose& robot) {
  const Frame frame(robot);
  const double reach = std::max({1.0, options_.free_radius, length_of(scan.eye.x, scan.eye.y)});
  Cell low = cell_of({robot.x - reach, robot.y - reach}), high = cell_of({robot.x + reach, robot.y + reach});
  const auto include = [&](const Cell& cell) {
    low = {std::min(low.x, cell.x - 1), std::min(low.y, cell.y - 1)};
    high = {std::max(high.x, cell.x + 1), std::max(high.y, cell.y + 1)};
  };
  include(cell_of(frame * scan.eye));
  for (const Beam& beam : scan.beams) include(cell_of(frame * beam.end));
  grow_to(low, high);
  ++scan_number_;
  changed_ = false;
}

void GridMap::add_hits(const Scan& scan, const Pose& robot, int origin) {
  begin_scan(scan, robot);
  inserted_origin_ = origin;
  const Frame frame(robot);
  for (const Beam& beam : scan.beams) {
    if (beam.hit) add_hit(beam, frame);
  }
}

bool GridMap::insert(const Scan& scan, const Pose& robot, int origin) {
  // Hits first: what this scan touches, its other beams do not erase.
  add_hits(scan, robot, origin);
  const Frame frame(robot);
  const Point eye = frame * scan.eye;
  for (const Beam& beam : scan.beams) see_through(eye, frame * beam.end);
  free_footprint(robot, scan.eye);
  return changed_;
}

bool GridMap::clear(const Scan& scan, const Pose& robot) {
  begin_scan(scan, robot);
  const Frame frame(robot);
  for (const Beam& beam : scan.beams) {
    if (beam.hit) touch(cell_of(frame * beam.end));
  }
  const Point eye = frame * scan.eye;
  for (const Beam& beam : scan.beams) see_through(eye, frame * beam.end);
  return changed_;
}

bool GridMap::touch(const Cell& cell) {
  uint32_t& touched = touched_[index_of(cell)];
  const bool first = touched != 2 * scan_number_ + 1;
  touched = 2 * scan_number_ + 1;
  return first;
}

void GridMap::add_hit(const Beam& beam, const Frame& robot) {
  const Point end = robot * beam.end;
  const Cell cell = cell_of(end);
  const bool first = touch(cell);
  if (first) change_odds(cell, occupied_step_);
  if (!beam.has_normal) return;
  add_to_surface(surface_of(cell), end, robot.turned(beam.normal), first);
  mark_surface(cell);
}

void GridMap::add_to_surface(Surface& surface, const Point& end, const Point& normal, bool first_of_scan) const {
  const double agreement = surface.normal_x * normal.x + surface.normal_y * normal.y;
  if (surface.hits > 0.0F && agreement <= 0.0) {
    // The far side of a thin wall: keep the side seen more.
    surface.hits -= 0.5F;
    if (surface.hits > 0.0F) return;
    surface = Surface{};
  }
  if (surface.hits <= 0.0F) surface.origin = inserted_origin_;
  surface.hits = std::min(surface.hits + 1.0F, kMemory);
  if (first_of_scan || surface.scans == 0.0F) surface.scans += 1.0F;
  const float share = 1.0F / surface.hits;
  surface.x += share * (static_cast<float>(end.x) - surface.x);
  surface.y += share * (static_cast<float>(end.y) - surface.y);
  surface.normal_x += share * (static_cast<float>(normal.x) - surface.normal_x);
  surface.normal_y += share * (static_cast<float>(normal.y) - surface.normal_y);
}

// Beams along a wall cross its cells without crossing its surface: only those that end well behind count against it.
bool GridMap::sees_through(const Surface& surface, const Ray& ray) const {
  const double behind = surface.normal_x * (surface.x - ray.end.x) + surface.normal_y * (surface.y - ray.end.y);
  const double squared = surface.normal_x * surface.normal_x + surface.normal_y * surface.normal_y;
  if (behind < kBehind * std::sqrt(squared)) return false;
  const double cross = ray.direction.x * (surface.y - ray.eye.y) - ray.direction.y * (surface.x - ray.eye.x);
  return std::abs(cross) < kSurfaceReach;
}

void GridMap::free_cell(const Cell& cell, const Ray& ray) {
  uint32_t& touched = touched_[index_of(cell)];
  if (touched >= 2 * scan_number_) return;
  const bool walled = has_surface(cell);
  if (walled && !sees_through(surface_of(cell), ray)) return;
  touched = 2 * scan_number_;
  change_odds(cell, -free_step_);
  if (walled && odds_[index_of(cell)] > 0) {
    surface_of(cell) = Surface{};
    mark_surface(cell);
  }
}

// Amanatides and Woo, A Fast Voxel Traversal Algorithm, 1987.
template <class Visit>
void GridMap::walk(const Ray& ray, double length, Visit visit) const {
  const Point& direction = ray.direction;
  const double r = options_.resolution;
  Cell cell = cell_of(ray.eye);
  const int step_x = direction.x < 0.0 ? -1 : 1, step_y = direction.y < 0.0 ? -1 : 1;
  const double far = std::numeric_limits<double>::infinity();
  const double delta_x = direction.x != 0.0 ? r / std::abs(direction.x) : far;
  const double delta_y = direction.y != 0.0 ? r / std::abs(direction.y) : far;
  double next_x = direction.x != 0.0 ? ((cell.x + (step_x > 0)) * r - ray.eye.x) / direction.x : far;
  double next_y = direction.y != 0.0 ? ((cell.y + (step_y > 0)) * r - ray.eye.y) / direction.y : far;
  double entered = 0.0;
  // Without branches: which border comes next is as good as random.
  while (entered < length && visit(cell)) {
    const bool across = next_x < next_y;
    entered = across ? next_x : next_y;
    next_x += across ? delta_x : 0.0;
    next_y += across ? 0.0 : delta_y;
    cell.x += across ? step_x : 0;
    cell.y += across ? 0 : step_y;
  }
}

void GridMap::see_through(const Point& eye, const Point& end) {
  const double length = length_of(end.x - eye.x, end.y - eye.y);
  if (length <= 0.0) return;
  walked_ += length;
  const Ray ray{eye, end, {(end.x - eye.x) / length, (end.y - eye.y) / length}};
  walk(ray, length, [&](const Cell& cell) {
    free_cell(cell, ray);
    return true;
  });
}

bool GridMap::known(const Cell& cell) const {
  const auto seen = [this](const Cell& at) { return contains(at) && seen_[index_of(at)] != 0; };
  return seen(cell) && seen({cell.x - 1, cell.y}) && seen({cell.x + 1, cell.y}) && seen({cell.x, cell.y - 1}) &&
         seen({cell.x, cell.y + 1});
}

bool GridMap::occupied(const Cell& cell) const { return seen_[index_of(cell)] != 0 && odds_[index_of(cell)] < 0; }

bool GridMap::hit_beside(const Cell& cell) const {
  for (int y = cell.y - 1; y <= cell.y + 1; ++y) {
    for (int x = cell.x - 1; x <= cell.x + 1; ++x) {
      if (contains({x, y}) && !has_surface({x, y}) && occupied({x, y})) return true;
    }
  }
  return false;
}

bool GridMap::blocked(const Point& eye, const Point& end) const {
  const double length = length_of(end.x - eye.x, end.y - eye.y);
  if (length <= 0.0) return false;
  const Ray ray{eye, end, {(end.x - eye.x) / length, (end.y - eye.y) / length}};
  bool found = false;
  walk(ray, length, [&](const Cell& cell) {
    found = contains(cell) && has_surface(cell) && sees_through(surface_of(cell), ray) && !stands_alone(cell);
    return !found;
  });
  return found;
}

bool GridMap::stands_alone(const Cell& middle) const {
  const int reach = static_cast<int>(std::ceil(options_.small_object_size / options_.resolution));
  const int side = 2 * reach + 1;
  std::vector<char> met(static_cast<std::size_t>(side) * side);
  std::vector<Cell> next{middle};
  Cell low = middle, high = middle;
  while (!next.empty()) {
    const Cell cell = next.back();
    next.pop_back();
    low = {std::min(low.x, cell.x), std::min(low.y, cell.y)};
    high = {std::max(high.x, cell.x), std::max(high.y, cell.y)};
    if (length_of(high.x - low.x, high.y - low.y) * options_.resolution > options_.small_object_size) return false;
    const auto meet = [&](const Cell& at) {
      const int column = at.x - middle.x + reach, row = at.y - middle.y + reach;
      if (column < 0 || row < 0 || column >= side || row >= side) return;
      char& known = met[static_cast<std::size_t>(row) * side + column];
      if (known == 0) next.push_back(at);
      known = 1;
    };
    visit_marked({cell.x - kGap, cell.y - kGap}, {cell.x + kGap, cell.y + kGap}, meet);
  }
  return true;
}

// The ground under the robot is free: a disc around its middle, and a strip from there to a laser beyond the disc, or
// one that looks away from the robot would leave it in unknown ground on all sides.
void GridMap::free_footprint(const Pose& robot, const Point& eye) {
  const double radius = options_.free_radius, arm = length_of(eye.x, eye.y);
  const double length = arm > radius ? arm : 0.0;
  const double reach = std::max(radius, length);
  const Frame frame(robot);
  const Point along = frame.turned(length > 0.0 ? Point{eye.x / arm, eye.y / arm} : Point{1.0, 0.0});
  const Cell low = cell_of({robot.x - reach, robot.y - reach}), high = cell_of({robot.x + reach, robot.y + reach});
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) {
      const double dx = (x + 0.5) * options_.resolution - robot.x, dy = (y + 0.5) * options_.resolution - robot.y;
      const double ahead = along.x * dx + along.y * dy, beside = std::abs(along.x * dy - along.y * dx);
      const bool on_strip = ahead > 0.0 && ahead <= length && beside <= kStripShare * radius;
      if (length_of(dx, dy) > radius && !on_strip) continue;
      if (touched_[index_of({x, y})] != 2 * scan_number_) change_odds({x, y}, -free_step_);
    }
  }
}

std::vector<int8_t> GridMap::occupancy() const {
  std::vector<int8_t> cells(seen_.size(), -1);
  for (std::size_t index = 0; index < cells.size(); ++index) {
    if (seen_[index]) cells[index] = odds_[index] < 0 ? 100 : 0;
  }
  return cells;
}

}  // namespace mr_robot::slam
