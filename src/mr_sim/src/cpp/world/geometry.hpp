// Plane geometry of the world engine. SI units, angles in radians, counter-clockwise.
#pragma once

#include <cmath>
#include <vector>

namespace mr_sim {

struct Point {
  double x = 0.0;
  double y = 0.0;
};

struct Pose {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
};

using Polygon = std::vector<Point>;

inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }
inline double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
inline double wrap_angle(double angle) { return std::remainder(angle, 2.0 * M_PI); }

// A point given in the frame of `pose`, in the frame that `pose` is given in.
inline Point transform(const Pose& pose, const Point& point) {
  const double c = std::cos(pose.yaw);
  const double s = std::sin(pose.yaw);
  return {pose.x + c * point.x - s * point.y, pose.y + s * point.x + c * point.y};
}

inline Pose compose(const Pose& a, const Pose& b) {
  const Point position = transform(a, {b.x, b.y});
  return {position.x, position.y, wrap_angle(a.yaw + b.yaw)};
}

// `pose` as seen from `reference`.
inline Pose relative(const Pose& reference, const Pose& pose) {
  const double c = std::cos(reference.yaw);
  const double s = std::sin(reference.yaw);
  const double dx = pose.x - reference.x;
  const double dy = pose.y - reference.y;
  return {c * dx + s * dy, -s * dx + c * dy, wrap_angle(pose.yaw - reference.yaw)};
}

// Distance along the ray to the segment a-b, infinity when it misses. `direction` is a unit vector.
double ray_segment(const Point& origin, const Point& direction, const Point& a, const Point& b);

// Whether two simple polygons share a point.
bool overlap(const Polygon& a, const Polygon& b);

}  // namespace mr_sim
