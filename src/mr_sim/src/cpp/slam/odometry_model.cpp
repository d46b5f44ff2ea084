#include "odometry_model.hpp"

#include <algorithm>

namespace mr_sim::slam {
namespace {

constexpr double kMemory = 40.0;  // windows after which what was learned is a running mean
constexpr double kCaution = 2.0;  // times what was seen of errors is what is expected
constexpr double kLeastError = 0.01;

}  // namespace

Gauge::Gauge(double window, double bias, double share, double least_share)
    : window_(window), least_share_(least_share), share_(share) {
  // As if one had seen the factor 1 so often that it is known as well as `bias` says, by windows that err by a tenth.
  squares_ = products_ = window * window * 0.01 / (bias * bias);
  error_ = share * share / (kCaution * kCaution);
}

void Gauge::learn(double odometry, double matched) {
  odometry_ += odometry;
  matched_ += matched;
  if (std::abs(odometry_) < window_) return;
  const double left = (matched_ - factor_ * odometry_) / odometry_;
  const double memory = std::min(windows_, kMemory);
  error_ += (left * left - error_) / (memory + 1.0);
  windows_ += 1.0;
  const double kept = 1.0 - 1.0 / kMemory;
  products_ = kept * products_ + odometry_ * matched_;
  squares_ = kept * squares_ + odometry_ * odometry_;
  factor_ = products_ / squares_;
  share_ = std::max(least_share_, kCaution * std::sqrt(error_));
  interrupt();
}

double Gauge::error() const { return std::max(kLeastError, std::sqrt(error_)); }

Pose OdometryModel::corrected(const Pose& motion) const {
  return {distance_.factor() * motion.x, distance_.factor() * motion.y, turn_.factor() * motion.yaw};
}

Pose OdometryModel::deviation(const Pose& motion) const {
  const double driven = 0.02 + distance_.share() * std::hypot(motion.x, motion.y);
  return {driven, driven, 0.0003 + turn_.share() * std::abs(motion.yaw)};
}

Pose OdometryModel::deviation_of_way(const Pose& motion) const {
  const double driven = 0.01 + distance_.error() * std::hypot(motion.x, motion.y);
  return {driven, driven, 0.002 + turn_.error() * std::abs(motion.yaw)};
}

void OdometryModel::learn(const Pose& motion, const Pose& matched) {
  distance_.learn(motion.x, matched.x);
  turn_.learn(motion.yaw, matched.yaw);
}

void OdometryModel::interrupt() {
  distance_.interrupt();
  turn_.interrupt();
}

}  // namespace mr_sim::slam
