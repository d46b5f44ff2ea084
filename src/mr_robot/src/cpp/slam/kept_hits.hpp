// What was hit from one place, kept for comparing places of long ago with those of now.
#pragma once

#include <cstddef>
#include <vector>

#include "grid_map.hpp"

namespace mr_robot::slam {

class KeptHits {
 public:
  // One more scan that entered the map there; hits of every third one are kept. `pose`: of the robot, seen from the
  // place.
  void add(const Scan& scan, const Pose& pose);
  // `place`: in the frame of the scan.
  void append_to(Scan* scan, const Pose& place) const;
  // m from the place within which all of them lie.
  double reach() const { return reach_; }
  // `place`: in the frame of the map; `origin`: what new surfaces are known by.
  void draw(GridMap* map, const Pose& place, int origin) const;

 private:
  struct Hit {
    float x, y, normal_x, normal_y;
  };
  using Hits = std::vector<Hit>;

  static void append(const Hits& hits, const Pose& place, Scan* scan);

  std::vector<Hits> scans_;
  std::size_t seen_ = 0;
  double reach_ = 0.0;
};

}  // namespace mr_robot::slam
