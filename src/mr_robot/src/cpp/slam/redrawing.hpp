// Draws a map anew with its keyframes elsewhere, some scans with each call.
#pragma once

#include <vector>

#include "grid_map.hpp"
#include "keyframes.hpp"

namespace mr_robot::slam {

class Redrawing {
 public:
  // `former`: the map in whose place the new one comes. `poses`: of the keyframes that there are.
  Redrawing(const GridOptions& grid, const GridMap& former, std::vector<Pose> poses);

  // Some scans more. Returns whether that were all.
  bool step(const Keyframes& keyframes);
  // Where a keyframe is on the new map, one that was opened since as well.
  Pose target(const Keyframes& keyframes, std::size_t keyframe) const;
  GridMap& map() { return map_; }

 private:
  GridMap map_;
  std::vector<Pose> poses_;
  std::size_t keyframe_ = 0, scan_ = 0;
};

}  // namespace mr_robot::slam
