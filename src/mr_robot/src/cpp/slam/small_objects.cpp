#include "small_objects.hpp"

#include <cmath>
#include <limits>

namespace mr_robot::slam {
namespace {

constexpr double kEndStep = 0.25;   // m in range from one beam to the next, at which a surface ends,
constexpr double kEndNoise = 0.08;  // m, or at less, by so much more than
constexpr double kGrazing = 5.67;   // cotangent of 10 degrees: on a surface that is seen at this angle
constexpr double kTouches = 0.36;   // of the size of a small object, from the robot's centre: what is nearer touches it

// Beams in a row without a step in range between them; of a laser that sees all around, the last ones of the scan may
// go on with its first ones.
struct Segment {
  std::size_t first, last;         // `last` counts on beyond the end of the scan
  bool before_left, before_right;  // it stands before what is seen beside it; so it does where the scan ends
};

double range_of(const Scan& scan, const Beam& beam) {
  return beam.hit ? length_of(beam.end.x - scan.eye.x, beam.end.y - scan.eye.y) : std::numeric_limits<double>::max();
}

// A breakpoint after Borges and Aldon (2004): close beams tell a gap from a surface that is seen from its side.
bool ends_between(const Scan& scan, const Beam& a, const Beam& b) {
  const double range = range_of(scan, a), next = range_of(scan, b), step = std::abs(range - next);
  if (step > kEndStep || !a.hit || !b.hit) return step > kEndStep;
  const Point to_a{a.end.x - scan.eye.x, a.end.y - scan.eye.y}, to_b{b.end.x - scan.eye.x, b.end.y - scan.eye.y};
  const double across = std::abs(to_a.x * to_b.y - to_a.y * to_b.x) / std::max(range, next);
  return step > kEndNoise + kGrazing * across;
}

void join_ends(const Scan& scan, std::vector<Segment>* segments) {
  if (ends_between(scan, scan.beams.back(), scan.beams.front())) {
    const double first = range_of(scan, scan.beams.front()), last = range_of(scan, scan.beams.back());
    segments->front().before_left = first < last;
    segments->back().before_right = last < first;
    return;
  }
  segments->back().last = scan.beams.size() + segments->front().last;
  segments->back().before_right = segments->front().before_right;
  segments->erase(segments->begin());
}

std::vector<Segment> segments_of(const Scan& scan) {
  std::vector<Segment> segments;
  double previous = 0.0;
  for (std::size_t i = 0; i < scan.beams.size(); ++i) {
    const double range = range_of(scan, scan.beams[i]);
    if (segments.empty() || ends_between(scan, scan.beams[i - 1], scan.beams[i])) {
      if (!segments.empty()) segments.back().before_right = previous < range;
      segments.push_back({i, i, segments.empty() || range < previous, true});
    }
    segments.back().last = i;
    previous = range;
  }
  if (scan.all_around && segments.size() > 1) join_ends(scan, &segments);
  return segments;
}

template <typename Beams>
auto& beam_at(Beams& beams, std::size_t index) {
  return beams[index % beams.size()];
}

// rad, from its first beam to its last one.
double view_of(const Scan& scan, const Segment& segment) {
  double view = 0.0;
  for (std::size_t i = segment.first; i < segment.last; ++i) {
    const Point &a = beam_at(scan.beams, i).end, &b = beam_at(scan.beams, i + 1).end;
    const double ax = a.x - scan.eye.x, ay = a.y - scan.eye.y, bx = b.x - scan.eye.x, by = b.y - scan.eye.y;
    view += std::abs(std::atan2(ax * by - ay * bx, ax * bx + ay * by));
  }
  return view;
}

// What takes up more than half a turn is around the laser, not beside it: walls of a room, near as their ends may be.
bool is_small(const Scan& scan, const Segment& segment, double size) {
  const Beam &first = scan.beams[segment.first], &last = beam_at(scan.beams, segment.last);
  return first.hit && length_of(first.end.x - last.end.x, first.end.y - last.end.y) < size &&
         view_of(scan, segment) < M_PI;
}

// A robot that drives ahead keeps off. What touches holds this one, so it may as well be a wall.
bool touches(const Scan& scan, const Segment& segment, double size) {
  for (std::size_t i = segment.first; i <= segment.last; ++i) {
    const Point& end = beam_at(scan.beams, i).end;
    if (length_of(end.x, end.y) < kTouches * size) return true;
  }
  return false;
}

}  // namespace

void mark_small_objects(Scan& scan, double size) {
  const std::vector<Segment> segments = segments_of(scan);
  // What touches hides walls behind it as often as robots.
  const auto stands_free = [&](std::size_t index) {
    const Segment& segment = segments[index % segments.size()];
    return segment.before_left && segment.before_right && is_small(scan, segment, size) &&
           !touches(scan, segment, size);
  };
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Segment& segment = segments[i];
    // One object may hide a part of another.
    const bool left = segment.before_left || stands_free(i + segments.size() - 1);
    const bool right = segment.before_right || stands_free(i + 1);
    if (!left || !right || !is_small(scan, segment, size) || touches(scan, segment, size)) continue;
    for (std::size_t j = segment.first; j <= segment.last; ++j) beam_at(scan.beams, j).on_small_object = true;
  }
}

}  // namespace mr_robot::slam
