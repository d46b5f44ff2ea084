#include "surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace mr_robot::navigation {
namespace {

constexpr std::size_t kPatchHits = 8;          // that make a surface
constexpr double kStraight = 0.5 * kTouching;  // m, standard deviation of hits from a line up to which they are one

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
  const auto cell = cell_of(walls.map, point.x, point.y);
  return cell && walls.distance[*cell] < static_cast<float>(within);
}

// What the scan reads in the direction of the point, m; 0 beside its field of view and where nothing is valid. Angles
// of lasers run from -pi on as well as from 0.
double reading_towards(const Point& point, const Point& eye, double heading, const ScanView& scan) {
  const double bearing = std::remainder(std::atan2(point.y - eye.y, point.x - eye.x) - heading, 2.0 * M_PI);
  const double steps = (bearing - scan.angle_min) / scan.angle_increment;
  const double turn = 2.0 * M_PI / std::abs(scan.angle_increment);
  const double beam = std::nearbyint(steps - turn * std::floor((steps + 0.5) / turn));
  if (!(beam >= 0.0 && beam < static_cast<double>(scan.range_count))) return 0.0;
  return scan.ranges[static_cast<std::size_t>(beam)];
}

// Whether the scan looks through the point, or would hit it if it were still there.
bool seen_gone(const Point& point, const Point& eye, double heading, const ScanView& scan, double beyond) {
  return reading_towards(point, eye, heading, scan) > std::hypot(point.x - eye.x, point.y - eye.y) + beyond;
}

// Whether a valid reading of the scan goes in that direction, so that it would show what is there.
bool in_view(const Point& point, const Point& eye, double heading, const ScanView& scan) {
  return reading_towards(point, eye, heading, scan) > 0.0;
}

struct Line {
  double x, y, cosine, sine;  // a point and the direction
  bool straight;              // whether the points lie on it
  Point nearest(const Point& point) const {
    const double along = cosine * (point.x - x) + sine * (point.y - y);
    return {x + cosine * along, y + sine * along};
  }
};

// Through all points as well as one line can.
Line line_through(const Point* points, std::size_t count) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    x += points[i].x / count;
    y += points[i].y / count;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = points[i].x - x, dy = points[i].y - y;
    xx += dx * dx / count;
    xy += dx * dy / count;
    yy += dy * dy / count;
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy), c = std::cos(angle), s = std::sin(angle);
  const double off = s * s * xx - 2.0 * s * c * xy + c * c * yy;
  return {x, y, c, s, off <= kStraight * kStraight};
}

bool within(const Point& point, const Pose& pose, double reach) {
  const double dx = point.x - pose.x, dy = point.y - pose.y;
  return dx * dx + dy * dy < reach * reach;
}

double distance(const Point& a, const Point& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return std::sqrt(dx * dx + dy * dy);  // std::hypot takes several times as long
}

// Close to the robot hits lie denser than they are exact: the mean of many beams says where a surface is, while the
// nearest of them seems to touch a robot that stands beside it.
std::vector<Point> smoothed(const ScanView& scan, double reach) {
  std::vector<Point> result(scan.points, scan.points + scan.point_count);
  const auto near = [&](std::size_t i, std::size_t k) {
    return distance(scan.points[i], scan.points[k]) < 2.0 * kTouching;
  };
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!within(scan.points[i], {0.0, 0.0, 0.0}, reach)) continue;
    std::size_t first = i, last = i;
    while (first > 0 && near(i, first - 1)) --first;
    while (last + 1 < result.size() && near(i, last + 1)) ++last;
    const std::size_t count = last + 1 - first;
    if (count < kPatchHits) continue;
    const Line line = line_through(scan.points + first, count);
    if (line.straight) result[i] = line.nearest(scan.points[i]);
  }
  return result;
}

// A point where the laser is blind, and the last one that it sees of the same surface. Robot's frame.
struct Beyond {
  Point point, edge;
};

// What is close beside the robot at an edge of the field of view goes on where the laser is blind: beside a wall a
// robot that turns touches it with a corner that it does not see. `surface`: m of it that tell its direction; `length`:
// m that it goes on.
void continue_edge(const ScanView& scan, bool first, double surface, double length, double reach,
                   std::vector<Beyond>& result) {
  const auto edge_of = [&](std::size_t i) { return first ? scan.points[i] : scan.points[scan.point_count - 1 - i]; };
  const Point edge = edge_of(0);
  const double end = first ? scan.angle_min : scan.angle_min + scan.angle_increment * (scan.range_count - 1.0);
  const double bearing = std::atan2(edge.y - scan.mount.y, edge.x - scan.mount.x) - scan.mount.yaw;
  const double at_edge = kPatchHits * std::abs(scan.angle_increment);
  if (std::hypot(edge.x, edge.y) > reach || std::abs(std::remainder(bearing - end, 2.0 * M_PI)) > at_edge) return;
  std::vector<Point> patch;
  for (std::size_t i = 0; i < scan.point_count && distance(edge_of(i), edge) < surface; ++i) {
    patch.push_back(edge_of(i));
  }
  if (patch.size() < kPatchHits) return;
  const Line line = line_through(patch.data(), patch.size());
  if (!line.straight) return;
  const Point from = line.nearest(edge), inside = line.nearest(patch.back());
  const double extent = distance(from, inside);
  if (extent < 2.0 * kTouching) return;
  const double x = (from.x - inside.x) / extent, y = (from.y - inside.y) / extent;
  for (int i = 1; i <= std::lround(length / kTouching); ++i) {
    result.push_back({{from.x + i * kTouching * x, from.y + i * kTouching * y}, edge});
  }
}

std::vector<Beyond> continued(const ScanView& scan, double surface, double length, double reach) {
  std::vector<Beyond> result;
  const double beams = static_cast<double>(scan.range_count) - 1.0 + 2.0 * kPatchHits;
  if (scan.point_count == 0 || scan.range_count < 2 || beams * std::abs(scan.angle_increment) > 2.0 * M_PI)
    return result;
  continue_edge(scan, true, surface, length, reach, result);
  continue_edge(scan, false, surface, length, reach, result);
  return result;
}

// Keeps the nearest obstacle of each square, and all that are close.
class Nearest {
 public:
  // `close`: m from the robot's middle.
  Nearest(const Pose& pose, double close, std::size_t most)
      : pose_(pose), close_within_(close), squares_(kTouching, most) {}

  void add(const Obstacle& obstacle) {
    const double dx = obstacle.x - pose_.x, dy = obstacle.y - pose_.y, squared = dx * dx + dy * dy;
    if (squared < close_within_ * close_within_) {
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
  double close_within_;
  Squares squares_;
  std::vector<Obstacle> kept_, close_;
  std::vector<double> squared_;
};

std::vector<Point> walls_near(const Map& map, const Pose& pose, double reach) {
  std::vector<Point> points;
  const auto first = [&](double from) { return static_cast<int>(std::clamp(std::floor(from), 0.0, 1e9)); };
  const auto last = [&](double to, int count) {
    return static_cast<int>(std::clamp(std::floor(to), -1.0, count - 1.0));
  };
  const double column = (pose.x - map.origin_x) / map.resolution, row = (pose.y - map.origin_y) / map.resolution;
  const double cells = reach / map.resolution;
  for (int r = first(row - cells); r <= last(row + cells, map.rows); ++r) {
    for (int c = first(column - cells); c <= last(column + cells, map.columns); ++c) {
      if (map.cells[static_cast<std::size_t>(r) * map.columns + c] <= 50) continue;
      points.push_back({map.origin_x + (c + 0.5) * map.resolution, map.origin_y + (r + 0.5) * map.resolution});
    }
  }
  return points;
}

// What is known of a place without seeing it.
class BlindMap {
 public:
  BlindMap(const Walls& merged, const Map* own, const Pose& pose, double reach)
      : merged_(merged.map), own_(own), surface_(merged.same_surface()) {
    for (const Point& wall : walls_near(merged.map, pose, reach)) {
      if (own == nullptr || !is_known(*own, wall.x, wall.y)) walls_.push_back({wall, own != nullptr});
    }
    if (own == nullptr) return;
    for (const Point& wall : walls_near(*own, pose, reach)) {
      if (is_wall(merged, wall, surface_)) walls_.push_back({wall, false});
    }
  }

  struct Wall {
    Point place;
    bool foreign;  // only other robots have mapped it
  };
  const std::vector<Wall>& walls() const { return walls_; }

  // Whether nothing is there, nor beside it.
  bool is_open(const Point& point) const {
    const bool known = (own_ != nullptr && is_known(*own_, point.x, point.y)) || is_known(merged_, point.x, point.y);
    return known && std::none_of(walls_.begin(), walls_.end(), [&](const Wall& wall) {
             return within(wall.place, {point.x, point.y, 0.0}, surface_);
           });
  }

 private:
  const Map& merged_;
  const Map* own_;
  double surface_;
  std::vector<Wall> walls_;
};

}  // namespace

std::vector<Point> hits(double* ranges, std::size_t count, const Point* directions, double range_min, double range_max,
                        const Point& mount) {
  std::vector<Point> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    // Comparisons with what is no number are false.
    ranges[i] = ranges[i] > 0.0 && ranges[i] >= range_min ? std::min(ranges[i], range_max) : 0.0;
    if (!(ranges[i] > 0.0 && ranges[i] < range_max)) continue;
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
  const double surface = walls.same_surface();
  for (std::size_t i = 0; i < scan.point_count; ++i) {
    const Point hit = place(scan.points[i]);
    if (!is_wall(walls, hit, surface)) keep({hit.x, hit.y, now});
  }
  const Point eye = place({scan.mount.x, scan.mount.y});
  const double heading = pose.yaw + scan.mount.yaw;
  for (const Remembered& point : old) {
    const bool valid = now - point.time < memory.duration && point.time <= now;
    if (valid && !seen_gone({point.x, point.y}, eye, heading, scan, surface)) keep(point);
  }
  return kept;
}

std::vector<Obstacle> surroundings(const ScanView& scan, const Pose& pose, const std::vector<Remembered>& remembered,
                                   const Walls& walls, const Map* own, const Footprint& footprint,
                                   const Margins& margins, double reach) {
  const double surface = walls.same_surface();
  const BlindMap blind(walls, own, pose, reach);
  const std::vector<Beyond> beyond = continued(scan, surface, 2.0 * footprint.half_length, reach);
  const std::size_t most = scan.point_count + remembered.size() + blind.walls().size() + beyond.size();
  // A robot that turns may touch what is this close, and the nearest point of a square to its middle is not the nearest
  // to a corner.
  const double close = std::hypot(footprint.half_length, footprint.half_width) + margins.moving + 2.0 * kTouching;
  Nearest nearest(pose, close, most);
  const Placement place(pose);
  for (const Point& point : smoothed(scan, reach)) {
    if (!within(point, {0.0, 0.0, 0.0}, reach)) continue;
    const Point hit = place(point);
    const bool known = is_wall(walls, hit, surface);
    nearest.add(known ? Obstacle{hit.x, hit.y, margins.obstacle, 0.0}
                      : Obstacle{hit.x, hit.y, margins.moving, margins.reaction_time});
  }
  for (const Remembered& point : remembered) {
    if (within({point.x, point.y}, pose, reach)) nearest.add({point.x, point.y, margins.moving, margins.reaction_time});
  }
  std::vector<Point> guessed;
  for (const auto& [point, edge] : beyond) {
    // Where the robot is no surface goes on: the few hits that tell its direction did not tell it well.
    if (std::abs(point.x) < footprint.half_length && std::abs(point.y) < footprint.half_width) continue;
    const Point there = place(point);
    // Where the map shows free ground a wall has ended, but what moves goes on.
    const bool moves = point.x < 0.0 && blind.is_open(place(edge));
    if (!moves && blind.is_open(there)) continue;
    guessed.push_back(there);
    nearest.add({there.x, there.y, margins.obstacle, 0.0});
  }
  const Point eye = place({scan.mount.x, scan.mount.y});
  for (const BlindMap::Wall& wall : blind.walls()) {
    const auto same = [&](const Point& point) { return distance(point, wall.place) < surface; };
    if (std::any_of(guessed.begin(), guessed.end(), same)) continue;
    if (in_view(wall.place, eye, pose.yaw + scan.mount.yaw, scan)) continue;
    nearest.add({wall.place.x, wall.place.y, wall.foreign ? margins.foreign : margins.wall, 0.0});
  }
  return nearest.all();
}

std::vector<Obstacle> outside(const std::vector<Obstacle>& obstacles, const Pose& pose, const Footprint& footprint) {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  std::vector<Obstacle> result;
  result.reserve(obstacles.size());
  std::copy_if(obstacles.begin(), obstacles.end(), std::back_inserter(result), [&](const Obstacle& obstacle) {
    const double dx = obstacle.x - pose.x, dy = obstacle.y - pose.y;
    return std::abs(c * dx + s * dy) - footprint.half_length > -kTouching ||
           std::abs(-s * dx + c * dy) - footprint.half_width > -kTouching;
  });
  return result;
}

}  // namespace mr_robot::navigation
