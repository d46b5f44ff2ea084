#include "surfaces.hpp"

#include <algorithm>
#include <cmath>

#include "rollout.hpp"

namespace mr_robot::navigation {
namespace {

constexpr std::size_t kPatchHits = 8;          // that make a surface
constexpr double kStraight = 0.5 * kTouching;  // m, standard deviation of hits from a line up to which they are one

struct Line {
  double x, y, cosine, sine;  // a point and the direction
  bool straight;              // whether the points lie on it
  Point nearest(const Point& point) const {
    const double along = cosine * (point.x - x) + sine * (point.y - y);
    return {x + cosine * along, y + sine * along};
  }
};

// Through all points as well as one line can.
Line line_through(const Point* points, std::size_t count) {
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    x += points[i].x / count;
    y += points[i].y / count;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = points[i].x - x, dy = points[i].y - y;
    xx += dx * dx / count;
    xy += dx * dy / count;
    yy += dy * dy / count;
  }
  const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy), c = std::cos(angle), s = std::sin(angle);
  const double off = s * s * xx - 2.0 * s * c * xy + c * c * yy;
  return {x, y, c, s, off <= kStraight * kStraight};
}

void continue_edge(const ScanView& scan, bool first, double surface, const Footprint& footprint, double reach,
                   std::vector<Beyond>& result) {
  const auto edge_of = [&](std::size_t i) { return first ? scan.points[i] : scan.points[scan.point_count - 1 - i]; };
  const Point edge = edge_of(0);
  const double end = first ? scan.angle_min : scan.angle_min + scan.angle_increment * (scan.range_count - 1.0);
  const double bearing = std::atan2(edge.y - scan.mount.y, edge.x - scan.mount.x) - scan.mount.yaw;
  const double at_edge = kPatchHits * std::abs(scan.angle_increment);
  if (std::hypot(edge.x, edge.y) > reach || std::abs(mr_grid::normalized(bearing - end)) > at_edge) return;
  std::vector<Point> patch;
  for (std::size_t i = 0; i < scan.point_count && distance(edge_of(i), edge) < surface; ++i) {
    patch.push_back(edge_of(i));
  }
  if (patch.size() < kPatchHits) return;
  const Line line = line_through(patch.data(), patch.size());
  if (!line.straight) return;
  const Point from = line.nearest(edge), inside = line.nearest(patch.back());
  const double extent = distance(from, inside);
  if (extent < 2.0 * kTouching) return;
  const double x = (from.x - inside.x) / extent, y = (from.y - inside.y) / extent;
  std::vector<Beyond> beyond;
  for (int i = 1; i <= std::lround(2.0 * footprint.half_length / kTouching); ++i) {
    const Point point{from.x + i * kTouching * x, from.y + i * kTouching * y};
    // The few hits that tell its direction did not tell it well.
    if (footprint.distance(point) < 0.0) return;
    beyond.push_back({point, edge});
  }
  result.insert(result.end(), beyond.begin(), beyond.end());
}

}  // namespace

std::vector<Point> smoothed(const ScanView& scan, double reach) {
  std::vector<Point> result(scan.points, scan.points + scan.point_count);
  const auto near = [&](std::size_t i, std::size_t k) {
    return distance(scan.points[i], scan.points[k]) < 2.0 * kTouching;
  };
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (!within(scan.points[i], {0.0, 0.0}, reach)) continue;
    std::size_t first = i, last = i;
    while (first > 0 && near(i, first - 1)) --first;
    while (last + 1 < result.size() && near(i, last + 1)) ++last;
    const std::size_t count = last + 1 - first;
    if (count < kPatchHits) continue;
    const Line line = line_through(scan.points + first, count);
    if (line.straight) result[i] = line.nearest(scan.points[i]);
  }
  return result;
}

std::vector<Beyond> continued(const ScanView& scan, double surface, const Footprint& footprint, double reach) {
  std::vector<Beyond> result;
  const double beams = static_cast<double>(scan.range_count) - 1.0 + 2.0 * kPatchHits;
  if (scan.point_count == 0 || scan.range_count < 2 || beams * std::abs(scan.angle_increment) > 2.0 * M_PI)
    return result;
  continue_edge(scan, true, surface, footprint, reach, result);
  continue_edge(scan, false, surface, footprint, reach, result);
  return result;
}

}  // namespace mr_robot::navigation
