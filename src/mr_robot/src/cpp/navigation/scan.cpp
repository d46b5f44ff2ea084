#include "scan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mr_robot::navigation {

std::vector<Point> hits(double* ranges, std::size_t count, const Point* directions, double range_min, double range_max,
                        const Point& mount) {
  std::vector<Point> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    // Comparisons with what is no number are false.
    ranges[i] = ranges[i] > 0.0 && ranges[i] >= range_min ? std::min(ranges[i], range_max) : 0.0;
    if (!(ranges[i] > 0.0 && ranges[i] < range_max)) continue;
    points.push_back({directions[i].x * ranges[i] + mount.x, directions[i].y * ranges[i] + mount.y});
  }
  return points;
}

namespace {

std::optional<double> beam_towards(const Point& point, const Point& eye, double heading, const ScanView& scan) {
  const double bearing = mr_grid::normalized(std::atan2(point.y - eye.y, point.x - eye.x) - heading);
  const double steps = (bearing - scan.angle_min) / scan.angle_increment;
  const double turn = 2.0 * M_PI / std::abs(scan.angle_increment);
  const double beam = std::nearbyint(steps - turn * std::floor((steps + 0.5) / turn));
  if (!(beam >= 0.0 && beam < static_cast<double>(scan.range_count))) return std::nullopt;
  return scan.ranges[static_cast<std::size_t>(beam)];
}

}  // namespace

double reading_towards(const Point& point, const Point& eye, double heading, const ScanView& scan) {
  return beam_towards(point, eye, heading, scan).value_or(0.0);
}

bool seen_gone(const Point& point, const Point& eye, double heading, const ScanView& scan, double beyond) {
  return reading_towards(point, eye, heading, scan) > std::hypot(point.x - eye.x, point.y - eye.y) + beyond;
}

bool too_near(const Point& point, const Point& eye, double heading, const ScanView& scan) {
  return within(point, eye, scan.range_min) && beam_towards(point, eye, heading, scan) == 0.0;
}

bool in_view(const Point& point, const Point& eye, double heading, const ScanView& scan) {
  return reading_towards(point, eye, heading, scan) > 0.0;
}

}  // namespace mr_robot::navigation
