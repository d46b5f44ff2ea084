// Points and poses in the plane, and their algebra: what pose.py is for Python. Metres and radians, REP-103 axes.
#pragma once

#include <cmath>

namespace mr_grid {

struct Point {
  double x = 0.0, y = 0.0;  // m
};

// A pose in a frame, or that frame's transform: turn by `yaw`, then shift by `x`, `y`.
struct Pose {
  double x = 0.0, y = 0.0;  // m
  double yaw = 0.0;         // rad
};

inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
inline double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }

// m; std::hypot is several times as slow, for numbers that no map has.
inline double length_of(double x, double y) { return std::sqrt(x * x + y * y); }
inline double length_of(const Point& vector) { return length_of(vector.x, vector.y); }

// The same angle in [-pi, pi].
inline double normalized(double angle) { return std::remainder(angle, 2.0 * M_PI); }

// A pose ready to transform many points.
class Frame {
 public:
  explicit Frame(const Pose& pose) : x_(pose.x), y_(pose.y), cos_(std::cos(pose.yaw)), sin_(std::sin(pose.yaw)) {}

  // A point given in this frame, in the frame that the pose is given in.
  Point operator*(const Point& point) const {
    return {x_ + cos_ * point.x - sin_ * point.y, y_ + sin_ * point.x + cos_ * point.y};
  }
  Point turned(const Point& vector) const {
    return {cos_ * vector.x - sin_ * vector.y, sin_ * vector.x + cos_ * vector.y};
  }
  // A point given in the frame of the pose, as seen from the pose.
  Point seen(const Point& point) const {
    const double x = point.x - x_, y = point.y - y_;
    return {cos_ * x + sin_ * y, -sin_ * x + cos_ * y};
  }

 private:
  double x_, y_, cos_, sin_;
};

inline Point operator*(const Pose& frame, const Point& point) { return Frame(frame) * point; }

// `pose`, given in the frame of the other one, in the frame that this is given in.
inline Pose operator*(const Pose& frame, const Pose& pose) {
  const Point origin = frame * Point{pose.x, pose.y};
  return {origin.x, origin.y, normalized(frame.yaw + pose.yaw)};
}

// `to` as seen from `from`.
inline Pose between(const Pose& from, const Pose& to) {
  const Point place = Frame(from).seen({to.x, to.y});
  return {place.x, place.y, normalized(to.yaw - from.yaw)};
}

// The frame that the pose is given in, as seen from it.
inline Pose inverse(const Pose& pose) {
  const double c = std::cos(pose.yaw), s = std::sin(pose.yaw);
  return {-c * pose.x - s * pose.y, s * pose.x - c * pose.y, normalized(-pose.yaw)};
}

}  // namespace mr_grid
