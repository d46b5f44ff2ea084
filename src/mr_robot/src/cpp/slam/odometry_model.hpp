// What a robot's odometry is worth: learned from how the poses that scans gave have followed it.
#pragma once

#include "pose.hpp"

namespace mr_robot::slam {

// How far the robot drove and turned, however much of it to and fro.
struct Way {
  double distance = 0.0, turn = 0.0;  // m, rad
};

inline Way operator-(const Way& a, const Way& b) { return {a.distance - b.distance, a.turn - b.turn}; }

// One quantity, distance or turn: by which factor odometry counts it wrong, and how much it errs besides. What it errs
// by from step to step is independent: its variance grows with the way.
class Gauge {
 public:
  // `window`: way that is compared as a whole, so that the noise of single matches does not count; `bias`: standard
  // deviation of the factor before anything is known of it; `walk`: of what it errs by besides after 1 m or 1 rad,
  // same; `slip`: the same where wheels may slip; `least_share`: of the way, by which it may always err.
  Gauge(double window, double bias, double walk, double slip, double least_share);

  double factor() const { return factor_; }
  // Standard deviation of what odometry errs by after a way: with caution, for wheels may slip, and as it was seen.
  double expected(double way) const;
  double seen(double way) const;
  void learn(double odometry, double matched);
  // What was gathered for a window cannot be compared.
  void interrupt() { odometry_ = matched_ = way_ = 0.0; }

 private:
  double window_, least_share_;
  double factor_ = 1.0;
  double odometry_ = 0.0, matched_ = 0.0, way_ = 0.0;  // in this window
  double products_, squares_;  // of matched and odometry, odometry and odometry, over the windows
  // Means of what is left, squared, of 1 m or 1 rad, with what was taken to be so at first, and over how many windows.
  double expected_, seen_, windows_ = 0.0;
};

class OdometryModel {
 public:
  // Motion of the robot, in its own frame, that odometry counts as `motion`.
  Pose corrected(const Pose& motion) const;
  // Standard deviations of that, for a step between two scans.
  Pose deviation(const Pose& motion) const;
  // The same for a longer way, over which no wheel has slipped.
  Pose deviation_of_way(const Way& way) const;
  // Between two matches that held. `along`: share of the scan in what is known of the way; the rest is odometry's word.
  void learn(const Pose& motion, const Pose& matched, double along);
  void interrupt();

 private:
  Gauge distance_{0.5, 0.03, 0.03, 0.18, 0.5}, turn_{0.5, 0.05, 0.06, 0.06, 0.03};
};

}  // namespace mr_robot::slam
