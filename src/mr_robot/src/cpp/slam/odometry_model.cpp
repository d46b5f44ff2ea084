#include "odometry_model.hpp"

#include <algorithm>

namespace mr_robot::slam {
namespace {

constexpr double kMemory = 40.0;      // windows after which what was learned is a running mean
constexpr double kCaution = 2.0;      // times what was seen of errors is what is expected
constexpr double kLeastWalk = 0.007;  // after 1 m or 1 rad

}  // namespace

Gauge::Gauge(double window, double bias, double walk, double least_share)
    : window_(window), least_share_(least_share), variance_(walk * walk) {
  // As if one had seen the factor 1 so often that it is known as well as `bias` says, by windows that err by a tenth.
  squares_ = products_ = window * window * 0.01 / (bias * bias);
}

void Gauge::learn(double odometry, double matched) {
  odometry_ += odometry;
  matched_ += matched;
  way_ += std::abs(odometry);
  if (way_ < window_) return;
  const double left = matched_ - factor_ * odometry_;
  variance_ += (left * left / way_ - variance_) / (std::min(windows_, kMemory) + 1.0);
  windows_ += 1.0;
  const double kept = 1.0 - 1.0 / kMemory;
  products_ = kept * products_ + odometry_ * matched_;
  squares_ = kept * squares_ + odometry_ * odometry_;
  factor_ = products_ / squares_;
  interrupt();
}

double Gauge::expected(double way) const { return std::max(least_share_ * way, kCaution * std::sqrt(variance_ * way)); }

double Gauge::seen(double way) const { return std::max(kLeastWalk, std::sqrt(variance_)) * std::sqrt(way); }

Pose OdometryModel::corrected(const Pose& motion) const {
  return {distance_.factor() * motion.x, distance_.factor() * motion.y, turn_.factor() * motion.yaw};
}

Pose OdometryModel::deviation(const Pose& motion) const {
  const double driven = 0.02 + distance_.expected(std::hypot(motion.x, motion.y));
  return {driven, driven, 0.0003 + turn_.expected(std::abs(motion.yaw))};
}

Pose OdometryModel::deviation_of_way(const Way& way) const {
  const double turned = 0.002 + turn_.seen(way.turn);
  const double driven = 0.01 + distance_.seen(way.distance);
  return {driven, driven + turned * way.distance, turned};
}

void OdometryModel::learn(const Pose& motion, const Pose& matched) {
  distance_.learn(motion.x, matched.x);
  turn_.learn(motion.yaw, matched.yaw);
}

void OdometryModel::interrupt() {
  distance_.interrupt();
  turn_.interrupt();
}

}  // namespace mr_robot::slam
