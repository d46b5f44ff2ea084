#include "geometry.hpp"

#include <limits>

namespace mr_sim {

double ray_segment(const Point& origin, const Point& direction, const Point& a, const Point& b) {
  constexpr double miss = std::numeric_limits<double>::infinity();
  const Point edge = b - a;
  const double denominator = cross(direction, edge);
  if (denominator == 0.0) return miss;
  const Point offset = a - origin;
  const double along_ray = cross(offset, edge) / denominator;
  const double along_edge = cross(offset, direction) / denominator;
  return along_ray >= 0.0 && along_edge >= 0.0 && along_edge <= 1.0 ? along_ray : miss;
}

namespace {

bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double side_c = cross(b - a, c - a);
  const double side_d = cross(b - a, d - a);
  const double side_a = cross(d - c, a - c);
  const double side_b = cross(d - c, b - c);
  return side_c * side_d <= 0.0 && side_a * side_b <= 0.0 && !(side_c == 0.0 && side_d == 0.0);
}

bool contains(const Polygon& polygon, const Point& point) {
  bool inside = false;
  for (size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
    const Point& a = polygon[i];
    const Point& b = polygon[j];
    if ((a.y > point.y) != (b.y > point.y) && point.x < (b.x - a.x) * (point.y - a.y) / (b.y - a.y) + a.x) {
      inside = !inside;
    }
  }
  return inside;
}

}  // namespace

bool overlap(const Polygon& a, const Polygon& b) {
  if (a.empty() || b.empty()) return false;
  if (contains(a, b.front()) || contains(b, a.front())) return true;
  for (size_t i = 0; i < a.size(); ++i) {
    for (size_t j = 0; j < b.size(); ++j) {
      if (segments_cross(a[i], a[(i + 1) % a.size()], b[j], b[(j + 1) % b.size()])) return true;
    }
  }
  return false;
}

}  // namespace mr_sim
