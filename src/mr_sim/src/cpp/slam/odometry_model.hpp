// What a robot's odometry is worth: learned from how the poses that scans gave have followed it.
#pragma once

#include "pose.hpp"

namespace mr_sim::slam {

// One quantity, distance or turn: by which factor odometry counts it wrong, and how much it errs besides.
class Gauge {
 public:
  // `window`: of the quantity that is compared as a whole, so that the noise of single matches does not count;
  // `bias`: standard deviation of the factor before anything is known of it; `share`, `least_share`: of the quantity,
  // by which it errs besides, at first and at best.
  Gauge(double window, double bias, double share, double least_share);

  double factor() const { return factor_; }
  // Of the quantity: standard deviation of what odometry errs by.
  double share() const { return share_; }
  // What was seen of that, as far as it can be known.
  double error() const;
  void learn(double odometry, double matched);
  // What was gathered for a window cannot be compared.
  void interrupt() { odometry_ = matched_ = 0.0; }

 private:
  double window_, least_share_;
  double factor_ = 1.0, share_;
  double odometry_ = 0.0, matched_ = 0.0;  // in this window
  double products_, squares_;              // of matched and odometry, odometry and odometry, over the windows
  double error_, windows_ = 1.0;           // mean of the squared share that is left, and over how many
};

class OdometryModel {
 public:
  // Motion of the robot, in its own frame, that odometry counts as `motion`.
  Pose corrected(const Pose& motion) const;
  // Standard deviations of that.
  Pose deviation(const Pose& motion) const;
  // The same for a longer way, over which the errors that have been seen add up and no wheel has slipped.
  Pose deviation_of_way(const Pose& motion) const;
  // Between two matches that held.
  void learn(const Pose& motion, const Pose& matched);
  void interrupt();

 private:
  Gauge distance_{0.5, 0.03, 0.5, 0.5}, turn_{0.5, 0.05, 0.2, 0.1};
};

}  // namespace mr_sim::slam
