// Points and the frames that they are told in.
#pragma once

#include <cmath>

#include "rollout.hpp"

namespace mr_robot::navigation {

struct Point {
  double x, y;  // m
};

// Places points of one frame in that which the frame is given in.
class Placement {
 public:
  explicit Placement(const Pose& frame) : frame_(frame), cosine_(std::cos(frame.yaw)), sine_(std::sin(frame.yaw)) {}
  Point operator()(const Point& point) const {
    return {point.x * cosine_ - point.y * sine_ + frame_.x, point.x * sine_ + point.y * cosine_ + frame_.y};
  }

 private:
  Pose frame_;
  double cosine_, sine_;
};

inline bool within(const Point& point, const Pose& pose, double reach) {
  const double dx = point.x - pose.x, dy = point.y - pose.y;
  return dx * dx + dy * dy < reach * reach;
}

inline double distance(const Point& a, const Point& b) {
  const double dx = a.x - b.x, dy = a.y - b.y;
  return std::sqrt(dx * dx + dy * dy);  // std::hypot takes several times as long
}

}  // namespace mr_robot::navigation
