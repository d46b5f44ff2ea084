#include "surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mr_sim::navigation {
namespace {

// m; a robot that turns may touch what is this close with a corner, and the nearest point of a square to its middle is
// not the nearest to that corner.
constexpr double kClose = 0.45;

// Numbers the squares of the plane that points lie in, in the order in which they come.
class Squares {
 public:
  Squares(double size, std::size_t most) : size_(size) {
    std::size_t slots = 16;
    while (slots < 2 * most) slots *= 2;
    slots_.assign(slots, {0, 0, kNone});
  }

  // The number of the point's square; as many as there were before if it is new.
  std::size_t number(double x, double y) {
    const auto column = static_cast<std::int64_t>(std::floor(x / size_));
    const auto row = static_cast<std::int64_t>(std::floor(y / size_));
    const std::uint64_t hash = (static_cast<std::uint64_t>(column) * 0x9E3779B97F4A7C15U) ^
                               (static_cast<std::uint64_t>(row) * 0xC2B2AE3D27D4EB4FU);
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = (hash >> 20) & mask;
    while (slots_[slot].number != kNone && (slots_[slot].column != column || slots_[slot].row != row)) {
      slot = (slot + 1) & mask;
    }
    if (slots_[slot].number == kNone) slots_[slot] = {column, row, count_++};
    return slots_[slot].number;
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  struct Slot {
    std::int64_t column, row;
    std::size_t number;
  };
  double size_;
  std::vector<Slot> slots_;
  std::size_t count_ = 0;
};

// Places points of one frame in that which the frame is given in.
class Placement {
 public:
  explicit Placement(const Pose& frame) : frame_(frame), cosine_(std::cos(frame.yaw)), sine_(std::sin(frame.yaw)) {}
  Point operator()(const Point& point) const {
    return {point.x * cosine_ - point.y * sine_ + frame_.x, point.x * sine_ + point.y * cosine_ + frame_.y};
  }

 private:
  Pose frame_;
  double cosine_, sine_;
};

bool is_wall(const Walls& walls, const Point& point, double within) {
  const double column = std::floor((point.x - walls.origin_x) / walls.resolution);
  const double row = std::floor((point.y - walls.origin_y) / walls.resolution);
  if (!(row >= 0.0 && column >= 0.0 && row < walls.rows && column < walls.columns)) return false;
  const std::size_t index = static_cast<std::size_t>(row) * walls.columns + static_cast<std::size_t>(column);
  return walls.distance[index] < static_cast<float>(within);
}

// Whether the scan looks through the point, or would hit it if it were still there.
bool seen_gone(const Point& point, const Point& eye, double heading, const ScanView& scan, double beyond) {
  const double dx = point.x - eye.x, dy = point.y - eye.y;
  const double bearing = std::remainder(std::atan2(dy, dx) - heading, 2.0 * M_PI);
  const double beam = std::nearbyint((bearing - scan.angle_min) / scan.angle_increment);
  if (!(beam >= 0.0 && beam < static_cast<double>(scan.range_count))) return false;
  return scan.ranges[static_cast<std::size_t>(beam)] > std::hypot(dx, dy) + beyond;
}

// Keeps the nearest obstacle of each square, and all that are close.
class Nearest {
 public:
  Nearest(const Pose& pose, double spacing, std::size_t most) : pose_(pose), squares_(spacing, most) {}

  void add(const Obstacle& obstacle) {
    const double dx = obstacle.x - pose_.x, dy = obstacle.y - pose_.y, squared = dx * dx + dy * dy;
    if (squared < kClose * kClose) {
      close_.push_back(obstacle);
      return;
    }
    const std::size_t number = squares_.number(obstacle.x, obstacle.y);
    if (number == kept_.size()) {
      kept_.push_back(obstacle);
      squared_.push_back(squared);
    } else if (squared < squared_[number]) {
      kept_[number] = obstacle;
      squared_[number] = squared;
    }
  }

  std::vector<Obstacle> all() {
    kept_.insert(kept_.end(), close_.begin(), close_.end());
    return std::move(kept_);
  }

 private:
  Pose pose_;
  Squares squares_;
  std::vector<Obstacle> kept_, close_;
  std::vector<double> squared_;
};

std::vector<Point> walls_near(const Walls& walls, const Pose& pose, double reach) {
  std::vector<Point> points;
  const auto first = [&](double from) { return static_cast<int>(std::clamp(std::floor(from), 0.0, 1e9)); };
  const auto last = [&](double to, int count) {
    return static_cast<int>(std::clamp(std::floor(to), -1.0, count - 1.0));
  };
  const double column = (pose.x - walls.origin_x) / walls.resolution,
               row = (pose.y - walls.origin_y) / walls.resolution;
  const double cells = reach / walls.resolution;
  for (int r = first(row - cells); r <= last(row + cells, walls.rows); ++r) {
    for (int c = first(column - cells); c <= last(column + cells, walls.columns); ++c) {
      if (walls.cells[static_cast<std::size_t>(r) * walls.columns + c] <= 50) continue;
      points.push_back({walls.origin_x + (c + 0.5) * walls.resolution, walls.origin_y + (r + 0.5) * walls.resolution});
    }
  }
  return points;
}

bool within(const Point& point, const Pose& pose, double reach) {
  const double dx = point.x - pose.x, dy = point.y - pose.y;
  return dx * dx + dy * dy < reach * reach;
}

}  // namespace

std::vector<Point> hits(double* ranges, std::size_t count, const Point* directions, double range_min, double range_max,
                        const Point& mount) {
  constexpr double kSmallest = 1e-3;  // m, of a reading, and below range_max for a hit
  std::vector<Point> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    // Comparisons with what is no number are false.
    ranges[i] = ranges[i] >= std::max(range_min, kSmallest) ? std::min(ranges[i], range_max) : 0.0;
    if (!(ranges[i] > 0.0 && ranges[i] < range_max - kSmallest)) continue;
    points.push_back({directions[i].x * ranges[i] + mount.x, directions[i].y * ranges[i] + mount.y});
  }
  return points;
}

std::vector<Remembered> remember(const std::vector<Remembered>& old, const ScanView& scan, const Pose& pose,
                                 const Walls& walls, const Memory& memory, double now) {
  std::vector<Remembered> kept;
  Squares squares(memory.cell, scan.point_count + old.size());
  const auto keep = [&](const Remembered& point) {
    if (kept.size() < memory.most && squares.number(point.x, point.y) == kept.size()) kept.push_back(point);
  };
  const Placement place(pose);
  for (std::size_t i = 0; i < scan.point_count; ++i) {
    const Point hit = place(scan.points[i]);
    if (!is_wall(walls, hit, memory.known_within)) keep({hit.x, hit.y, now});
  }
  const Point eye = place({scan.mount.x, scan.mount.y});
  const double heading = pose.yaw + scan.mount.yaw;
  for (const Remembered& point : old) {
    const bool valid = now - point.time < memory.duration && point.time <= now;
    if (valid && !seen_gone({point.x, point.y}, eye, heading, scan, memory.seen_beyond)) keep(point);
  }
  return kept;
}

std::vector<Obstacle> surroundings(const ScanView& scan, const Pose& pose, const std::vector<Remembered>& remembered,
                                   const Walls& walls, const Margins& margins, double known_within, double reach,
                                   double spacing) {
  const std::vector<Point> of_map = walls_near(walls, pose, reach);
  Nearest nearest(pose, spacing, scan.point_count + remembered.size() + of_map.size());
  const Placement place(pose);
  for (std::size_t i = 0; i < scan.point_count; ++i) {
    if (!within(scan.points[i], {0.0, 0.0, 0.0}, reach)) continue;
    const Point hit = place(scan.points[i]);
    const bool known = is_wall(walls, hit, known_within);
    nearest.add(known ? Obstacle{hit.x, hit.y, margins.obstacle, 0.0}
                      : Obstacle{hit.x, hit.y, margins.moving, margins.reaction_time});
  }
  for (const Remembered& point : remembered) {
    if (within({point.x, point.y}, pose, reach)) nearest.add({point.x, point.y, margins.moving, margins.reaction_time});
  }
  for (const Point& wall : of_map) nearest.add({wall.x, wall.y, margins.wall, 0.0});
  return nearest.all();
}

}  // namespace mr_sim::navigation
