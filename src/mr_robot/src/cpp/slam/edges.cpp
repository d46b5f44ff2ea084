#include "edges.hpp"

#include <algorithm>
#include <optional>

#include "spread.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kJump = 0.35;           // m farther away is what comes into sight
constexpr double kBehind = 0.1;          // m behind the line of the surface, at least
constexpr double kLongest = 0.4;         // m of the surface before its end that tell its line
constexpr std::size_t kLeastHits = 8;    // on it
constexpr double kStraight = 0.04;       // m off it at most
constexpr double kWidestGap = 0.08;      // m from one beam to the next on a surface whose end is told
constexpr double kLeastIncidence = 0.1;  // sine of the angle to the surface: less is seen of what is round
constexpr double kNoise = 0.01;          // m
constexpr double kSameInPlace = 0.1;     // m within which edges seen from nearly one place are one
constexpr double kSameWay = 0.8;         // cosine

double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y; }
double cross(const Point& a, const Point& b) { return a.x * b.y - a.y * b.x; }
Point minus(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y}; }

struct Line {
  Point through;
  Point along;  // unit vector, towards the end
};

// `hits`: the first is the one towards which the line runs.
Line fitted(const std::vector<Point>& hits) {
  Spread spread;
  for (const Point& hit : hits) spread.add(minus(hit, hits.front()));
  const Point mean{hits.front().x + spread.mean().x, hits.front().y + spread.mean().y};
  const double angle = spread.along();
  Point along{std::cos(angle), std::sin(angle)};
  if (dot(along, minus(hits.front(), mean)) < 0.0) along = {-along.x, -along.y};
  return {mean, along};
}

// Of hits that follow one another on a surface, from its end on: as many of them as lie on a line.
std::optional<Line> line_through(std::vector<Point> hits) {
  while (hits.size() >= kLeastHits) {
    const Line line = fitted(hits);
    const auto off = [&line](const Point& hit) { return std::abs(cross(line.along, minus(hit, line.through))); };
    if (std::all_of(hits.begin(), hits.end(), [&](const Point& hit) { return off(hit) < kStraight; })) return line;
    hits.resize(hits.size() * 2 / 3);
  }
  return std::nullopt;
}

// On an average, for single hits err by more.
bool is_on(const Line& line, const std::vector<Point>& hits) {
  double off = 0.0;
  for (const Point& hit : hits) off += std::abs(cross(line.along, minus(hit, line.through)));
  return off < kStraight * static_cast<double>(hits.size());
}

// The line of the surface that ends at `index`; `step`: to the next hit on it, 1 or -1. None unless all of it lies on
// that line for more than `size`: a robot may stand so near to a wall that both look like one.
std::optional<Line> line_before(const std::vector<Beam>& beams, std::size_t index, int step, double size) {
  std::vector<Point> near, beyond;
  Point last = beams[index].end;
  for (std::size_t i = index; i < beams.size() && beams[i].hit; i += step) {
    const Point gap = minus(beams[i].end, last), way = minus(beams[i].end, beams[index].end);
    const double length = std::hypot(way.x, way.y);
    if (std::hypot(gap.x, gap.y) > 2.0 * kWidestGap) break;
    (length <= kLongest ? near : beyond).push_back(last = beams[i].end);
    if (length <= size) continue;
    const auto line = line_through(near);
    return line && is_on(*line, beyond) ? line : std::nullopt;
  }
  return std::nullopt;
}

// Where the surface seen by the beam ends because the beam beside it, `next`, passes it by.
std::optional<Edge> edge_at(const Scan& scan, std::size_t index, std::size_t next, double size) {
  const Beam &near = scan.beams[index], &far = scan.beams[next];
  if (!near.hit || std::max(near.index, far.index) - std::min(near.index, far.index) != 1) return std::nullopt;
  const Point ray = minus(near.end, scan.eye), far_ray = minus(far.end, scan.eye);
  const double range = std::hypot(ray.x, ray.y), far_range = std::hypot(far_ray.x, far_ray.y);
  if (far_range < range + kJump) return std::nullopt;
  const auto line = line_before(scan.beams, index, index < next ? -1 : 1, size);
  if (!line) return std::nullopt;
  Point normal{-line->along.y, line->along.x};
  if (dot(normal, ray) > 0.0) normal = {-normal.x, -normal.y};
  const double incidence = -dot(normal, ray) / range;
  const double between = std::abs(cross(ray, far_ray)) / (range * far_range);  // rad
  const double spacing = range * between / std::max(incidence, 1e-3);
  if (incidence < kLeastIncidence || spacing > kWidestGap) return std::nullopt;
  if (-dot(normal, minus(far.end, line->through)) < kBehind) return std::nullopt;
  const double end = dot(line->along, minus(near.end, line->through)) + 0.5 * spacing;
  const Point place{line->through.x + end * line->along.x, line->through.y + end * line->along.y};
  return Edge{place, line->along, normal, std::hypot(0.5 * spacing, kNoise)};
}

}  // namespace

bool same_edge(const Edge& a, const Edge& b, double reach) {
  const Point apart = minus(a.place, b.place);
  return std::hypot(apart.x, apart.y) < reach && dot(a.off, b.off) > kSameWay && dot(a.normal, b.normal) > kSameWay;
}

std::vector<Edge> edges_of(const Scan& scan, double small_object_size) {
  std::vector<Edge> edges;
  for (std::size_t i = 0; i + 1 < scan.beams.size(); ++i) {
    if (const auto edge = edge_at(scan, i, i + 1, small_object_size)) edges.push_back(*edge);
    if (const auto edge = edge_at(scan, i + 1, i, small_object_size)) edges.push_back(*edge);
  }
  return edges;
}

void KeptEdges::add(const Scan& scan, const Pose& pose, double small_object_size) {
  const Frame frame(pose);
  for (const Edge& seen : edges_of(scan, small_object_size)) {
    const Edge edge = frame * seen;
    const auto same = [&edge](const Kept& kept) { return same_edge(kept.edge, edge, kSameInPlace); };
    const auto found = std::find_if(kept_.begin(), kept_.end(), same);
    if (found == kept_.end()) {
      kept_.push_back({edge, 1});
      continue;
    }
    const double share = 1.0 / ++found->seen;
    Edge& mean = found->edge;
    mean.place.x += share * (edge.place.x - mean.place.x);
    mean.place.y += share * (edge.place.y - mean.place.y);
    mean.deviation += share * (edge.deviation - mean.deviation);
  }
}

std::vector<Edge> KeptEdges::edges() const {
  std::vector<Edge> edges;
  for (const Kept& kept : kept_) edges.push_back(kept.edge);
  return edges;
}

}  // namespace mr_robot::slam
