#include "ghosts.hpp"

#include <algorithm>
#include <cmath>

#include "obstacles.hpp"

namespace map_merger {
namespace {

// Adds the cells at most `radius` metres from the place.
void add_disc(Mask& mask, const Place& place, double radius, double resolution) {
  const double squared = (radius / resolution) * (radius / resolution);
  std::int64_t across = static_cast<std::int64_t>(std::sqrt(squared)) + 1;
  for (std::int64_t down = 0; down * down <= squared; ++down) {
    while (static_cast<double>(down * down + across * across) > squared) --across;
    mask.set(place.row + down, place.column - across, place.column + across + 1);
    mask.set(place.row - down, place.column - across, place.column + across + 1);
  }
}

bool small(const Obstacle& obstacle, const GhostRules& rules) {
  const std::int64_t extent = std::max(obstacle.bottom - obstacle.top, obstacle.right - obstacle.left);
  return static_cast<double>(extent) * rules.resolution <= rules.largest;
}

bool middle_in(const Obstacle& obstacle, const Mask& mask) {
  // Not rounded to even, with which the cell would depend on where the window begins.
  const auto middle = [&](std::int64_t sum) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(sum) / static_cast<double>(obstacle.area) + 0.5));
  };
  return mask.at(middle(obstacle.rows), middle(obstacle.columns));
}

std::int64_t count_in(const Run& run, const Mask& mask) {
  std::int64_t count = 0;
  for (std::int64_t column = run.left; column < run.right; ++column) count += mask.at(run.row, column);
  return count;
}

// What a map says about others' obstacles: floor all around, walls within one and within `off` cells.
struct Seen {
  Mask floor, beside_wall, near_wall;
};

// Of the obstacles near the robot those that its own map, if there is one, does not confirm.
std::vector<bool> unconfirmed(const Obstacles& obstacles, const std::vector<bool>& suspects, const Mask* near_wall,
                              const GhostRules& rules) {
  if (near_wall == nullptr) return suspects;
  std::vector<std::int64_t> held(obstacles.all.size());
  for (const Run& run : obstacles.runs)
    if (suspects[run.obstacle]) held[run.obstacle] += count_in(run, *near_wall);
  std::vector<bool> left = suspects;
  for (std::size_t i = 0; i < left.size(); ++i)
    left[i] = left[i] && static_cast<double>(held[i]) < rules.confirmed * static_cast<double>(obstacles.all[i].area);
  return left;
}

// Small obstacles by themselves whose middle is near another robot that did not see them itself.
Mask alone(const Mask& walls, std::size_t map, const std::vector<Robot>& robots, const std::vector<Seen>& seen,
           const GhostRules& rules) {
  const Obstacles obstacles = obstacles_of(walls);
  std::vector<bool> ghost(obstacles.all.size());
  for (const Robot& robot : robots) {
    if (robot.map == map) continue;
    std::vector<bool> suspects(ghost.size());
    for (std::size_t i = 0; i < suspects.size(); ++i)
      suspects[i] = small(obstacles.all[i], rules) && middle_in(obstacles.all[i], robot.presence.near);
    suspects = unconfirmed(obstacles, suspects, robot.map ? &seen[*robot.map].near_wall : nullptr, rules);
    for (std::size_t i = 0; i < suspects.size(); ++i) ghost[i] = ghost[i] || suspects[i];
  }
  Mask result(walls.rows(), walls.columns());
  for (const Run& run : obstacles.runs)
    if (ghost[run.obstacle]) result.set(run.row, run.left, run.right);
  return result;
}

// What is touched by another robot, where another map shows floor and no other map a wall.
Mask touched(const Mask& none, std::size_t map, const std::vector<Robot>& robots, const std::vector<Seen>& seen) {
  Mask touching = none, floor = none;
  for (const Robot& robot : robots)
    if (robot.map != map) touching |= robot.presence.touching;
  if (!touching.any()) return touching;
  for (std::size_t other = 0; other < seen.size(); ++other)
    if (other != map) floor |= seen[other].floor;
  touching &= floor;
  for (std::size_t other = 0; other < seen.size(); ++other)
    if (other != map) touching.remove(seen[other].beside_wall);
  return touching;
}

}  // namespace

Presence presence_of(const std::vector<Place>& places, const Window& window, const GhostRules& rules) {
  const Mask none(window.bottom - window.top, window.right - window.left);
  Presence presence{none, none, none};
  const auto margin = static_cast<std::int64_t>(std::ceil(rules.near / rules.resolution)) + 1;
  for (const Place& place : places) {
    if (place.row < window.top - margin || place.row >= window.bottom + margin || place.column < window.left - margin ||
        place.column >= window.right + margin) {
      continue;
    }
    const Place inside{place.row - window.top, place.column - window.left};
    add_disc(presence.body, inside, rules.body, rules.resolution);
    add_disc(presence.touching, inside, rules.touching, rules.resolution);
    add_disc(presence.near, inside, rules.near, rules.resolution);
  }
  return presence;
}

bool may_be_seen(const Mask& walls, const Presence& robot, const GhostRules& rules) {
  if ((walls & robot.touching).any()) return true;
  const Obstacles obstacles = obstacles_of(walls);
  return std::any_of(obstacles.all.begin(), obstacles.all.end(), [&](const Obstacle& obstacle) {
    return small(obstacle, rules) && middle_in(obstacle, robot.near);
  });
}

std::vector<Mask> ghosts_of(const std::vector<Known>& maps, const std::vector<Robot>& robots, const GhostRules& rules) {
  std::vector<Seen> seen;
  for (const Known& map : maps)
    seen.push_back({shrunk(map.floor, rules.off), spread(map.wall, 1), spread(map.wall, rules.off)});
  std::vector<Mask> ghosts;
  for (std::size_t map = 0; map < maps.size(); ++map) {
    const Mask& walls = maps[map].wall;
    const Mask none(walls.rows(), walls.columns());
    Mask found = touched(none, map, robots, seen) | alone(walls, map, robots, seen, rules);
    for (const Robot& robot : robots) found |= robot.presence.body;
    ghosts.push_back(found & walls);
  }
  return ghosts;
}

}  // namespace map_merger
