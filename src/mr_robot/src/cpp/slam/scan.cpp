#include "scan.hpp"

#include <algorithm>

#include "small_objects.hpp"
#include "spread.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kStraight = 0.03;    // m off the line through two hits at most, of a third on the same wall
constexpr double kLongestStep = 2.0;  // m from one hit to the next on a wall that is seen at a grazing angle

bool turn_to(const Point& eye, const Point& at, Point* normal) {
  if (normal->x * (eye.x - at.x) + normal->y * (eye.y - at.y) < 0.0) *normal = {-normal->x, -normal->y};
  return true;
}

// Of three successive beams whose ends lie on one line: a wall seen at a grazing angle, on which hits are far apart.
bool normal_of_three(const std::vector<Beam>& beams, std::size_t first, Point* normal) {
  const Beam &a = beams[first], &b = beams[first + 1], &c = beams[first + 2];
  if (!a.hit || !b.hit || !c.hit) return false;
  const double x = c.end.x - a.end.x, y = c.end.y - a.end.y, length = length_of(x, y);
  const double px = b.end.x - a.end.x, py = b.end.y - a.end.y;
  const double along = (px * x + py * y) / length;
  if (length <= 0.0 || along <= 0.0 || along >= length) return false;
  if (std::max(along, length - along) > kLongestStep || std::abs(px * y - py * x) > kStraight * length) return false;
  *normal = {-y / length, x / length};
  return true;
}

bool fit_sparse_normal(const std::vector<Beam>& beams, std::size_t index, const Point& eye, Point* normal) {
  const std::size_t low = index < 2 ? 0 : index - 2;
  for (std::size_t first = low; first <= index && first + 2 < beams.size(); ++first) {
    if (normal_of_three(beams, first, normal)) return turn_to(eye, beams[index].end, normal);
  }
  return false;
}

// Direction of the line through the hits around `index`, by principal axes; needs three hits and some extent.
bool fit_normal(const std::vector<Beam>& beams, std::size_t index, double window, const Point& eye, Point* normal) {
  const Point center = beams[index].end;
  Spread spread;
  const auto add = [&](const Beam& beam) {
    const double x = beam.end.x - center.x, y = beam.end.y - center.y;
    if (!beam.hit || x * x + y * y > window * window) return false;
    spread.add({x, y});
    return true;
  };
  add(beams[index]);
  for (std::size_t i = index; i-- > 0 && add(beams[i]);) {
  }
  for (std::size_t i = index + 1; i < beams.size() && add(beams[i]); ++i) {
  }
  if (spread.count() < 3) return fit_sparse_normal(beams, index, eye, normal);
  const double large = spread.large();
  if (large < 25.0 * spread.small() || large < spread.count() * 0.04 * window * window) return false;
  const Point along = spread.along();
  *normal = {-along.y, along.x};
  return turn_to(eye, center, normal);
}

}  // namespace

Scan make_scan(const float* ranges, std::size_t size, const LaserGeometry& geometry, const ScanOptions& options) {
  const Frame mount(geometry.mount);
  const Pose& swept = geometry.swept;
  const bool moves = size > 1 && (swept.x != 0.0 || swept.y != 0.0 || swept.yaw != 0.0);
  Scan scan;
  scan.eye = {geometry.mount.x, geometry.mount.y};
  scan.beams.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    const double range = ranges[i];
    if (std::isnan(range) || range < std::max(geometry.range_min, 1e-3)) continue;
    const bool hit = range < std::min(geometry.range_max - 1e-3, options.reach);
    const double length = hit ? range : std::min(geometry.range_max, options.free_range);
    const double angle = geometry.angle_min + static_cast<double>(i) * geometry.angle_increment;
    Point end = mount * Point{length * std::cos(angle), length * std::sin(angle)};
    if (moves) {
      const double share = static_cast<double>(i) / static_cast<double>(size - 1);
      end = Pose{share * swept.x, share * swept.y, share * swept.yaw} * end;
    }
    scan.beams.push_back({end, hit});
    scan.beams.back().index = i;
  }
  scan.all_around = (static_cast<double>(size) + 0.5) * std::abs(geometry.angle_increment) > 2.0 * M_PI;
  mark_small_objects(scan, options.small_object_size);
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    Beam& beam = scan.beams[i];
    if (!beam.hit) continue;
    // Far hits may scatter too much to tell within the window which way their wall runs.
    beam.has_normal =
        fit_normal(scan.beams, i, options.surface_window, scan.eye, &beam.normal) ||
        (!beam.on_small_object && fit_normal(scan.beams, i, 2.0 * options.surface_window, scan.eye, &beam.normal));
    const Point ray{beam.end.x - scan.eye.x, beam.end.y - scan.eye.y};
    const double range = length_of(ray.x, ray.y);
    const double incidence = std::abs(beam.normal.x * ray.x + beam.normal.y * ray.y) / range;
    beam.spacing = range * std::abs(geometry.angle_increment) / std::max(0.1, incidence);
  }
  return scan;
}

// Whether a hit is used must not depend on its own noise: asking how far it lies from the last one would prefer, on
// each wall, hits that err in the direction of the sweep, and turn the robot a little with every match.
std::vector<const Beam*> spaced_hits(const Scan& scan) {
  std::vector<const Beam*> chosen;
  double passed = kHitSpacing;
  for (const Beam& beam : scan.beams) {
    if (!beam.has_normal || beam.on_small_object) continue;
    if (passed >= kHitSpacing) {
      chosen.push_back(&beam);
      passed = 0.0;
    }
    passed += beam.spacing;
  }
  return chosen;
}

}  // namespace mr_robot::slam
