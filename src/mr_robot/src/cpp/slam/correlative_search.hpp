// Where on a map does a scan lie, near a pose?
#pragma once

#include <vector>

#include "grid_map.hpp"
#include "scan.hpp"

namespace mr_robot::slam {

// Exhaustive search over a window (m, rad) around `center` (correlative matching, Olson 2009) on every fourth hit at
// most. For each turn all
// shifts are counted together, hit by hit: that is a sum of rows of bytes.
Pose correlative_search(const GridMap& map, const std::vector<const Beam*>& beams, const Pose& center,
                        const Pose& window);

}  // namespace mr_robot::slam
