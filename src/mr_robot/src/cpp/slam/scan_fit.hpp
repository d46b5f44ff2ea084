// Draws the hits of a scan to the surfaces of a map, from a pose near the one that is wanted.
#pragma once

#include <map>
#include <vector>

#include "evidence.hpp"
#include "grid_map.hpp"
#include "match_options.hpp"
#include "scan.hpp"
#include "surface_lines.hpp"

namespace mr_robot::slam {

// Of what hits say of the position where they say most of it: from this share on, all that they say where they say
// least counts.
constexpr double kTelling = 0.02;

// What is steady while a scan is matched.
struct Surroundings {
  const GridMap& map;
  const std::vector<const Beam*>& beams;
  Point eye;
  int long_ago;  // see match_scan
};

struct Fit {
  Pose pose;
  double share = 0.0;  // of the hits in known parts, those on a surface
  double known = 0.0;  // share of the hits that lie in known parts
  std::map<int, Evidence> origins{};
};

// Gauss-Newton on point-to-line distances with Cauchy weights and the odometry prior. `fresh`: surfaces that were seen
// once count as well.
Fit refine(const Surroundings& around, const Pose& start, const Pose& expected, const Pose& deviation,
           double surface_deviation, const MatchOptions& options, std::vector<Association>& associations,
           bool fresh = false);

// What the map says to the hits at a pose that is nearly found.
Fit judge_at(const Surroundings& around, const Pose& pose);

}  // namespace mr_robot::slam
