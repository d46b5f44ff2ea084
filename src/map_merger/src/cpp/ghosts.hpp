// Robots in maps. The rules are stated in ghosts.py.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drawing.hpp"
#include "mask.hpp"
#include "weighing.hpp"

namespace map_merger {

struct Place {
  std::int64_t row, column;
};

// Lengths in metres, but `off` in cells, and `confirmed`, a share.
struct GhostRules {
  double resolution, body, touching, near, largest, confirmed;
  std::int64_t off;
};

// Where one robot has been.
struct Presence {
  Mask body, touching, near;
};

// Of a robot that was at the places, in the cells of the window.
Presence presence_of(const std::vector<Place>& places, const Window& window, const GhostRules& rules);

// False if the robot can be no obstacle of a map with these walls.
bool may_be_seen(const Mask& walls, const Presence& robot, const GhostRules& rules);

struct Robot {
  Presence presence;
  std::optional<std::size_t> map;  // number of the one that it made
};

// For each map the walls in it that are robots.
std::vector<Mask> ghosts_of(const std::vector<Known>& maps, const std::vector<Robot>& robots, const GhostRules& rules);

}  // namespace map_merger
