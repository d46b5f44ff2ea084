// Lines through the surfaces of a map, to which hits are drawn.
#pragma once

#include "grid_map.hpp"

namespace mr_robot::slam {

struct Line {
  Point through, normal;  // m; unit vector
  double distance = 0.0;  // m, of the nearest surface
  double density = 0.0;   // 1: many hits
  double weight = 0.0;    // the same, and 0 for what one scan only has seen
  bool found = false;
  int origin = 0;  // of the nearest surface
};

// What was found for a hit, and where it was then.
struct Association {
  Point place;
  double reach = 0.0;  // m; 0: nothing was looked for yet
  Line line;
};

// The line within `reach` (m) of a hit on a surface that has `normal`, or nullptr. What was drawn long ago, up to
// origin `long_ago`, and what was drawn lately make no line together: the way between may have drifted. `known`: what
// was found for this hit before; most of the time of matching went into finding the same lines again.
const Line* line_of(const GridMap& map, const Point& point, const Point& normal, double reach, int long_ago,
                    Association& known);

}  // namespace mr_robot::slam
