#include "standing.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kLeastWay = 0.08;    // m by odometry from which scans tell motion from rest
constexpr double kLeastAngle = 0.07;  // rad
constexpr double kTolerance = 0.03;   // m between equal readings, plus
constexpr double kShare = 0.02;       // of the range
constexpr int kLeastCompared = 20;    // that are compared
constexpr double kSame = 0.55;        // of them that see what they saw, where the robot stands among others that move,
constexpr double kClearly = 0.25;     // and so many more than see what they would if it had moved
constexpr double kSeen = 0.1;         // so many more of them see that it moved
constexpr double kMayTouch = 0.5;     // m, what is nearer may touch, and
constexpr double kHides = 0.25;       // m nearer than what it hides
constexpr double kMostWay = 0.5;      // m, and
constexpr double kMostAngle = 0.6;    // rad by odometry that are waited for a verdict

bool equal(double a, double b) { return std::abs(a - b) < kTolerance + kShare * std::max(a, b); }

bool is_hit(float range, const LaserGeometry& geometry) {
  return range >= geometry.range_min && range < geometry.range_max - 1e-3;
}

// Whether a wall at `range` in the direction of the beam `at`, which may lie between two beams, is what these see. The
// nearest of few beams looks elsewhere, but on the way from what one hits to what the next one hits lies their surface.
bool sees(const float* ranges, std::size_t size, const LaserGeometry& geometry, double at, double range) {
  const float nearest = ranges[std::lround(at)];
  if (is_hit(nearest, geometry) && equal(nearest, range)) return true;
  const auto before = static_cast<std::size_t>(std::max(0.0, std::floor(at)));
  if (before + 1 >= size || !is_hit(ranges[before], geometry) || !is_hit(ranges[before + 1], geometry)) return false;
  const double step = std::abs(geometry.angle_increment), passed = step * (at - static_cast<double>(before));
  const double a = ranges[before], b = ranges[before + 1];
  return equal(range, a * b * std::sin(step) / (a * std::sin(passed) + b * std::sin(step - passed)));
}

std::vector<bool> readings_of_small_objects(const Scan& scan, std::size_t size) {
  std::vector<bool> found(size, false);
  for (const Beam& beam : scan.beams) found[beam.index] = beam.on_small_object;
  return found;
}

bool same_beams(const LaserGeometry& a, const LaserGeometry& b) {
  return a.angle_min == b.angle_min && a.angle_increment == b.angle_increment && a.mount.x == b.mount.x &&
         a.mount.y == b.mount.y && a.mount.yaw == b.mount.yaw;
}

}  // namespace

void Standing::keep(const float* ranges, std::size_t size, const LaserGeometry& geometry, const Scan& scan,
                    const Pose& odometry) {
  ranges_.assign(ranges, ranges + size);
  geometry_ = geometry;
  beams_ = scan.beams;
  odometry_ = odometry;
}

Standing::Verdict Standing::judge(const float* ranges, std::size_t size, const LaserGeometry& geometry,
                                  const Scan& scan, const Pose& odometry) {
  if (ranges_.size() != size || !same_beams(geometry_, geometry)) {
    keep(ranges, size, geometry, scan, odometry);
    return Verdict::kUnknown;
  }
  const Pose motion = between(odometry_, odometry);
  if (std::hypot(motion.x, motion.y) < kLeastWay && std::abs(motion.yaw) < kLeastAngle) return Verdict::kUndecided;
  const Frame to_laser(between(geometry.mount, Pose{}) * between(motion, Pose{}));
  const double middle = geometry.angle_min + 0.5 * static_cast<double>(size - 1) * geometry.angle_increment;
  const std::vector<bool> small = readings_of_small_objects(scan, size);
  // What comes into the view, and may touch, hides what would be seen. It may be nearer than what counts as a reading.
  const auto hidden = [&](long reading, double range) {
    const float now = ranges[reading];
    return small[reading] || (now > 0.0F && now < kMayTouch && now < range - kHides);
  };
  int compared = 0, same = 0, moved = 0;
  for (const Beam& beam : beams_) {
    // A robot that drives ahead, or around one that turns, looks as if one stood.
    if (!beam.hit || beam.on_small_object) continue;
    const Point end = to_laser * beam.end;
    const double at =
        normalized(std::atan2(end.y, end.x) - middle) / geometry.angle_increment + 0.5 * static_cast<double>(size - 1);
    const auto other = std::lround(at);
    if (other < 0 || other >= static_cast<long>(size)) continue;
    const double then = ranges_[beam.index], expected = length_of(end.x, end.y);
    // What motion takes out of reach says nothing of motion: of a short view that is much of all.
    if (expected >= geometry.range_max - 1e-3) continue;
    if (hidden(static_cast<long>(beam.index), then) || hidden(other, expected)) continue;
    ++compared;
    const float now = ranges[beam.index];
    same += is_hit(now, geometry) && equal(now, then);
    moved += sees(ranges, size, geometry, at, expected);
  }
  if (compared >= kLeastCompared && same >= kSame * compared && same - moved >= kClearly * compared) {
    odometry_ = odometry;
    return Verdict::kStands;
  }
  const bool far = compared == 0 || std::hypot(motion.x, motion.y) >= kMostWay || std::abs(motion.yaw) >= kMostAngle;
  const bool moves = compared > 0 && moved - same >= kSeen * compared;
  // Along a wall, or turned by little, a robot would see much the same.
  if (!moves && !far) return same - moved >= kSeen * compared ? Verdict::kSeemsToStand : Verdict::kUndecided;
  keep(ranges, size, geometry, scan, odometry);
  return moves ? Verdict::kMoved : Verdict::kUnknown;
}

}  // namespace mr_robot::slam
