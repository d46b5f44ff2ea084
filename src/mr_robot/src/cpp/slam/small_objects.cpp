#include "small_objects.hpp"

#include <cmath>
#include <limits>

namespace mr_robot::slam {
namespace {

constexpr double kStep = 0.25;      // m in range from one beam to the next, at which a surface ends
constexpr double kTouching = 0.36;  // of the size of a small object, from the robot's centre: what is nearer touches it

// Beams in a row without a step in range between them.
struct Segment {
  std::size_t first, last;
  bool before_left, before_right;  // it stands before what is seen beside it; so it does where the scan ends
};

std::vector<Segment> segments_of(const Scan& scan) {
  std::vector<Segment> segments;
  double previous = 0.0;
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    const Beam& beam = scan.beams[i];
    const double range =
        beam.hit ? std::hypot(beam.end.x - scan.eye.x, beam.end.y - scan.eye.y) : std::numeric_limits<double>::max();
    if (segments.empty() || std::abs(range - previous) > kStep) {
      if (!segments.empty()) segments.back().before_right = previous < range;
      segments.push_back({i, i, segments.empty() || range < previous, true});
    }
    segments.back().last = i;
    previous = range;
  }
  return segments;
}

bool is_small(const Scan& scan, const Segment& segment, double size) {
  const Point &first = scan.beams[segment.first].end, &last = scan.beams[segment.last].end;
  return scan.beams[segment.first].hit && std::hypot(first.x - last.x, first.y - last.y) < size;
}

// A robot that drives ahead keeps off. What touches holds this one, so it may as well be a wall.
bool touches(const Scan& scan, const Segment& segment, double size) {
  for (std::size_t i = segment.first; i <= segment.last; ++i) {
    if (std::hypot(scan.beams[i].end.x, scan.beams[i].end.y) < kTouching * size) return true;
  }
  return false;
}

}  // namespace

void mark_small_objects(Scan& scan, double size) {
  const std::vector<Segment> segments = segments_of(scan);
  // What touches hides walls behind it as often as robots.
  const auto stands_free = [&](std::size_t index) {
    const Segment& segment = segments[index];
    return segment.before_left && segment.before_right && is_small(scan, segment, size) &&
           !touches(scan, segment, size);
  };
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& segment = segments[i];
    // One object may hide a part of another.
    const bool left = segment.before_left || stands_free(i - 1), right = segment.before_right || stands_free(i + 1);
    if (!left || !right || !is_small(scan, segment, size) || touches(scan, segment, size)) continue;
    for (std::size_t j = segment.first; j <= segment.last; ++j) scan.beams[j].on_small_object = true;
  }
}

}  // namespace mr_robot::slam
