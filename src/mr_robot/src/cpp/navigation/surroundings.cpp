#include "surroundings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "squares.hpp"
#include "surfaces.hpp"

namespace mr_robot::navigation {
namespace {

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

}  // namespace

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
    if (too_near({point.x, point.y}, eye, heading, scan)) {
      keep({point.x, point.y, now});
      continue;
    }
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
  const std::vector<Beyond> beyond = continued(scan, surface, footprint, reach);
  const std::size_t most = scan.point_count + remembered.size() + blind.walls().size() + beyond.size();
  // A robot that turns may touch what is this close, and the nearest point of a square to its middle is not the nearest
  // to a corner.
  const double close = footprint.radius + margins.moving + 2.0 * kTouching;
  Nearest nearest(pose, close, most);
  const Placement place(pose);
  for (const Point& point : smoothed(scan, reach)) {
    if (!within(point, {0.0, 0.0}, reach)) continue;
    const Point hit = place(point);
    const bool known = is_wall(walls, hit, surface);
    nearest.add(known ? Obstacle{hit.x, hit.y, margins.obstacle, 0.0}
                      : Obstacle{hit.x, hit.y, margins.moving, margins.reaction_time});
  }
  for (const Remembered& point : remembered) {
    if (within({point.x, point.y}, {pose.x, pose.y}, reach))
      nearest.add({point.x, point.y, margins.moving, margins.reaction_time});
  }
  std::vector<Point> guessed;
  for (const auto& [point, edge] : beyond) {
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
  const mr_grid::Frame body(pose);
  std::vector<Obstacle> result;
  result.reserve(obstacles.size());
  std::copy_if(obstacles.begin(), obstacles.end(), std::back_inserter(result), [&](const Obstacle& obstacle) {
    return footprint.distance(body.seen({obstacle.x, obstacle.y})) > -kTouching;
  });
  return result;
}

}  // namespace mr_robot::navigation
