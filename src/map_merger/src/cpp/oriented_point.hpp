// Points of walls, and motions of the plane.
#pragma once

#include <cmath>

namespace map_merger {

// A point of a wall in metres, and its unit normal towards free space.
struct OrientedPoint {
  double x, y, normal_x, normal_y;
};

// Turns by yaw (rad), then shifts by x, y (m).
class Motion {
 public:
  Motion(double x, double y, double yaw) : x(x), y(y), yaw(yaw), cosine_(std::cos(yaw)), sine_(std::sin(yaw)) {}

  OrientedPoint operator*(const OrientedPoint& p) const {
    return {x + cosine_ * p.x - sine_ * p.y, y + sine_ * p.x + cosine_ * p.y, cosine_ * p.normal_x - sine_ * p.normal_y,
            sine_ * p.normal_x + cosine_ * p.normal_y};
  }

  // This motion after another one.
  Motion operator*(const Motion& other) const {
    return {x + cosine_ * other.x - sine_ * other.y, y + sine_ * other.x + cosine_ * other.y,
            std::remainder(yaw + other.yaw, 2.0 * M_PI)};
  }

  Motion inverse() const { return {-cosine_ * x - sine_ * y, sine_ * x - cosine_ * y, -yaw}; }

  double x, y, yaw;

 private:
  double cosine_, sine_;
};

}  // namespace map_merger
