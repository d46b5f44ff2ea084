// Poses in the plane and their composition.
#pragma once

#include <cmath>

namespace mr_robot::slam {

struct Point {
  double x = 0.0, y = 0.0;  // m
};

struct Pose {
  double x = 0.0, y = 0.0;  // m
  double yaw = 0.0;         // rad
};

// m; std::hypot is several times as slow, for numbers that no map has.
inline double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

inline double normalized(double angle) { return std::remainder(angle, 2.0 * M_PI); }

// A pose ready to transform many points.
class Frame {
 public:
  explicit Frame(const Pose& pose) : x_(pose.x), y_(pose.y), cos_(std::cos(pose.yaw)), sin_(std::sin(pose.yaw)) {}

  Point operator*(const Point& point) const {
    return {x_ + cos_ * point.x - sin_ * point.y, y_ + sin_ * point.x + cos_ * point.y};
  }
  Point turned(const Point& vector) const {
    return {cos_ * vector.x - sin_ * vector.y, sin_ * vector.x + cos_ * vector.y};
  }

 private:
  double x_, y_, cos_, sin_;
};

inline Point operator*(const Pose& frame, const Point& point) { return Frame(frame) * point; }

inline Pose operator*(const Pose& frame, const Pose& pose) {
  const Point origin = frame * Point{pose.x, pose.y};
  return {origin.x, origin.y, normalized(frame.yaw + pose.yaw)};
}

// Pose of `to` seen from `from`.
inline Pose between(const Pose& from, const Pose& to) {
  const double c = std::cos(from.yaw), s = std::sin(from.yaw);
  const double x = to.x - from.x, y = to.y - from.y;
  return {c * x + s * y, -s * x + c * y, normalized(to.yaw - from.yaw)};
}

inline double distance(const Pose& a, const Pose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

}  // namespace mr_robot::slam
