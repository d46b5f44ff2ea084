#include "odometry_model.hpp"

#include <algorithm>

namespace mr_robot::slam {
namespace {

constexpr double kMemory = 200.0;     // windows after which what was learned is a running mean
constexpr double kCaution = 2.0;      // times what was seen of errors is what is expected
constexpr double kUnseen = 0.1;       // after 1 m or 1 rad, before any errors were seen, and
constexpr double kDoubt = 0.25;       // how many windows that counts for
constexpr double kTold = 0.3;         // share of the scan in what is known of a way, from which it tells its length
constexpr double kLeastWalk = 0.007;  // after 1 m or 1 rad

}  // namespace

Gauge::Gauge(double window, double bias, double walk, double slip, double least_share)
    : window_(window), least_share_(least_share), expected_(slip * slip), seen_(kUnseen * kUnseen) {
  // As if one had seen the factor 1 so often that it is known as well as `bias` says.
  squares_ = products_ = window * walk * walk / (bias * bias);
}

void Gauge::learn(double odometry, double matched) {
  odometry_ += odometry;
  matched_ += matched;
  way_ += std::abs(odometry);
  if (way_ < window_) return;
  const double left = matched_ - factor_ * odometry_;
  const double squared = left * left / way_, windows = std::min(windows_, kMemory) + 1.0;
  expected_ += (squared - expected_) / (windows + 1.0);
  seen_ += (squared - seen_) / (windows + kDoubt);
  windows_ += 1.0;
  const double kept = 1.0 - 1.0 / kMemory;
  products_ = kept * products_ + odometry_ * matched_;
  squares_ = kept * squares_ + odometry_ * odometry_;
  factor_ = products_ / squares_;
  interrupt();
}

double Gauge::expected(double way) const { return std::max(least_share_ * way, kCaution * std::sqrt(expected_ * way)); }

double Gauge::seen(double way) const { return std::max(kLeastWalk, std::sqrt(seen_)) * std::sqrt(way); }

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

void OdometryModel::learn(const Pose& motion, const Pose& matched, double along) {
  // Where walls fix no position along them, odometry would confirm itself.
  if (along >= kTold) {
    const double led = distance_.factor() * motion.x;
    distance_.learn(motion.x, led + (matched.x - led) / along);
  } else {
    distance_.interrupt();
  }
  turn_.learn(motion.yaw, matched.yaw);
}

void OdometryModel::interrupt() {
  distance_.interrupt();
  turn_.interrupt();
}

}  // namespace mr_robot::slam
