#include "evidence.hpp"

#include <Eigen/Cholesky>

namespace mr_robot::slam {
namespace {

constexpr double kNear = 0.02;  // m and rad, deviation of the pose before the hits say anything

}  // namespace

void Evidence::add(double weight, double residual, const Eigen::Vector3d& jacobian) {
  information += weight * jacobian * jacobian.transpose();
  pull += weight * residual * jacobian;
  ++hits;
}

Evidence Evidence::operator+(const Evidence& other) const {
  return {information + other.information, pull + other.pull, hits + other.hits};
}

Eigen::Vector3d Evidence::step() const {
  const Eigen::Matrix3d near = Eigen::Vector3d::Constant(1.0 / (kNear * kNear)).asDiagonal();
  return -(information + near).ldlt().solve(pull);
}

Pose moved(const Pose& pose, const Eigen::Vector3d& step) {
  return {pose.x + step.x(), pose.y + step.y(), normalized(pose.yaw + step.z())};
}

}  // namespace mr_robot::slam
