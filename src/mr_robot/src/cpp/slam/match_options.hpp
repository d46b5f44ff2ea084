// How closely scans are matched.
#pragma once

namespace mr_robot::slam {

constexpr int kNothingOld = -1;  // no origin of long ago

struct MatchOptions {
  double surface_deviation;       // m, standard deviation of hits around surfaces
  double reach = 0.25;            // m, how far from a surface a hit may be to be drawn to it
  double joint_deviation = 0.03;  // m, the same where hits and odometry are weighed against one another
  double window = 0.4;            // m, half width of the search where odometry alone does not lead to a match
  double angular_window = 0.2;    // rad, same for the heading
  double good_share = 0.6;        // share of hits on surfaces that makes a match certain
  double poor_share = 0.3;        // share below which the scan contradicts the map
  double known_share = 0.15;      // of the hits that must lie in known parts for a match
};

}  // namespace mr_robot::slam
