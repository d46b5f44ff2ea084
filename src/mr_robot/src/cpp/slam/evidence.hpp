// What hits that lie on surfaces say of the robot's pose.
#pragma once

#include <Eigen/Core>

#include "pose.hpp"

namespace mr_robot::slam {

// Sums over hits, linearised where the pose is taken to be: x, y, yaw, in the map.
struct Evidence {
  // A hit: its weight (1/m²), its distance from the surface (m), and how that grows with the pose.
  void add(double weight, double residual, const Eigen::Vector3d& jacobian);
  Evidence operator+(const Evidence& other) const;
  // To where the hits alone would have the pose: near to where it is unless they say much.
  Eigen::Vector3d step() const;

  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d pull = Eigen::Vector3d::Zero();  // information times how far the pose is off
  int hits = 0;
};

Pose moved(const Pose& pose, const Eigen::Vector3d& step);

}  // namespace mr_robot::slam
