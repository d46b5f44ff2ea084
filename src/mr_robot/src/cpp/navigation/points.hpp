// Points around the robot.
#pragma once

#include <mr_grid/pose.hpp>

namespace mr_robot::navigation {

using mr_grid::Point;
using mr_grid::Pose;

// Places points of one frame in that which the frame is given in.
class Placement {
 public:
  explicit Placement(const Pose& frame) : frame_(frame), shift_{frame.x, frame.y} {}
  // Turned first and shifted then: it rounds otherwise than the frame itself.
  Point operator()(const Point& point) const {
    const Point turned = frame_.turned(point);
    return {turned.x + shift_.x, turned.y + shift_.y};
  }

 private:
  mr_grid::Frame frame_;
  Point shift_;
};

inline double distance(const Point& a, const Point& b) { return mr_grid::length_of(a - b); }

inline bool within(const Point& point, const Point& place, double reach) {
  const Point apart = point - place;
  return dot(apart, apart) < reach * reach;
}

}  // namespace mr_robot::navigation
