#include "edges.hpp"

#include <algorithm>
#include <optional>

#include "spread.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kJump = 0.35;           // m farther away is what comes into sight
constexpr double kBehindLine = 0.1;      // m behind the line of the surface, at least
constexpr double kLongest = 0.4;         // m of the surface before its end that tell its line
constexpr std::size_t kLeastHits = 8;    // on it
constexpr double kStraight = 0.04;       // m off it at most
constexpr double kWidestGap = 0.08;      // m from one beam to the next on a surface whose end is told
constexpr double kLeastIncidence = 0.1;  // sine of the angle to the surface: less is seen of what is round
constexpr double kDeepest = 0.3;         // m of the face of a wall's end, from
constexpr double kShallowest = 0.05;     // m on, on which there are
constexpr std::size_t kLeastOnFace = 2;  // hits, off it by no more than
constexpr double kUpright = 0.06;        // m
constexpr double kOfHit = 0.03;          // m, deviation of each
constexpr double kEdgeNoise = 0.01;      // m
constexpr double kSameInPlace = 0.1;     // m within which edges seen from nearly one place are one
constexpr double kThickest = 0.3;        // m of a wall
constexpr double kSameWay = 0.8;         // cosine

struct Line {
  Point through;
  Point along;  // unit vector, towards the end
};

// `hits`: the first is the one towards which the line runs.
Line fitted(const std::vector<Point>& hits) {
  Spread spread;
  for (const Point& hit : hits) spread.add(hit - hits.front());
  const Point mean{hits.front().x + spread.mean().x, hits.front().y + spread.mean().y};
  Point along = spread.along();
  if (dot(along, hits.front() - mean) < 0.0) along = {-along.x, -along.y};
  return {mean, along};
}

// Of hits that follow one another on a surface, from its end on: as many of them as lie on a line.
std::optional<Line> line_through(std::vector<Point> hits) {
  while (hits.size() >= kLeastHits) {
    const Line line = fitted(hits);
    const auto off = [&line](const Point& hit) { return std::abs(cross(line.along, hit - line.through)); };
    if (std::all_of(hits.begin(), hits.end(), [&](const Point& hit) { return off(hit) < kStraight; })) return line;
    hits.resize(hits.size() * 2 / 3);
  }
  return std::nullopt;
}

// On an average, for single hits err by more.
bool is_on(const Line& line, const std::vector<Point>& hits) {
  double off = 0.0;
  for (const Point& hit : hits) off += std::abs(cross(line.along, hit - line.through));
  return off < kStraight * static_cast<double>(hits.size());
}

// Hits from `index` on that follow one another; `step`: to the next, 1 or -1. No more than `length` m.
std::vector<Point> chain_from(const std::vector<Beam>& beams, std::size_t index, int step, double length) {
  std::vector<Point> chain;
  for (std::size_t i = index; i < beams.size() && beams[i].hit; i += step) {
    const Point& hit = beams[i].end;
    if (!chain.empty() && length_of(hit - chain.back()) > 2.0 * kWidestGap) break;
    chain.push_back(hit);
    if (length_of(hit - chain.front()) > length) break;
  }
  return chain;
}

// The line of a surface that ends at the hit `first`. None unless all of it lies on that line for more than `size`: a
// robot may stand so near to a wall that both look like one.
std::optional<Line> line_from(const std::vector<Point>& chain, std::size_t first, double size) {
  std::vector<Point> near, beyond;
  for (std::size_t i = first; i < chain.size(); ++i) {
    const double length = length_of(chain[i] - chain[first]);
    (length <= kLongest ? near : beyond).push_back(chain[i]);
    if (length <= size) continue;
    const auto line = line_through(near);
    return line && is_on(*line, beyond) ? line : std::nullopt;
  }
  return std::nullopt;
}

// How far along a line, m from what it goes through, its end's face is: `count` hits of the chain behind the line that
// lie one behind the other.
std::optional<double> face_of(const Line& line, const Point& normal, const std::vector<Point>& chain,
                              std::size_t count) {
  double sum = 0.0, deepest = 0.0, least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < count; ++i) {
    const Point from = chain[i] - line.through;
    const double along = dot(line.along, from);
    sum += along, least = std::min(least, along), most = std::max(most, along);
    deepest = std::max(deepest, -dot(normal, from));
  }
  if (deepest < kShallowest || most - least > 2.0 * kUpright) return std::nullopt;
  return sum / static_cast<double>(count);
}

// What ends a surface: the ray to its end, the beam beside it that passes it by, and the angle between both, rad.
struct Passing {
  Point ray, beyond;
  double angle;
};

// The end of the surface that begins with the hit `first`; those before it are on the face of its end.
std::optional<Edge> edge_of(const std::vector<Point>& chain, std::size_t first, const Passing& passing, double size) {
  const auto line = line_from(chain, first, size);
  if (!line) return std::nullopt;
  Point normal{-line->along.y, line->along.x};
  if (dot(normal, passing.ray) > 0.0) normal = {-normal.x, -normal.y};
  const double range = length_of(passing.ray), incidence = -dot(normal, passing.ray) / range;
  const double spacing = range * passing.angle / std::max(incidence, 1e-3);
  if (incidence < kLeastIncidence || spacing > kWidestGap) return std::nullopt;
  if (-dot(normal, passing.beyond - line->through) < kBehindLine) return std::nullopt;
  double end = dot(line->along, chain[first] - line->through) + 0.5 * spacing, deviation = 0.5 * spacing;
  if (first > 0) {
    const auto face = face_of(*line, normal, chain, first);
    if (!face || std::abs(*face - end) > kWidestGap) return std::nullopt;
    end = *face;
    deviation = kOfHit / std::sqrt(static_cast<double>(first));
  }
  const Point place{line->through.x + end * line->along.x, line->through.y + end * line->along.y};
  return Edge{place, line->along, normal, length_of(deviation, kEdgeNoise)};
}

// Where the surface seen by the beam ends because the beam beside it, `next`, passes it by. Of a wall seen from beyond
// its end comes the face of that end first.
std::optional<Edge> edge_at(const Scan& scan, std::size_t index, std::size_t next, double size) {
  const Beam &near = scan.beams[index], &far = scan.beams[next];
  if (!near.hit || std::max(near.index, far.index) - std::min(near.index, far.index) != 1) return std::nullopt;
  const Point ray = near.end - scan.eye, far_ray = far.end - scan.eye;
  const double range = length_of(ray), far_range = length_of(far_ray);
  if (far_range < range + kJump) return std::nullopt;
  const Passing passing{ray, far.end, std::abs(cross(ray, far_ray)) / (range * far_range)};
  const auto chain = chain_from(scan.beams, index, index < next ? -1 : 1, kDeepest + size);
  if (const auto edge = edge_of(chain, 0, passing, size)) return edge;
  for (std::size_t first = kLeastOnFace; first < chain.size(); ++first) {
    if (length_of(chain[first - 1] - chain.front()) > kDeepest) break;
    if (const auto edge = edge_of(chain, first, passing, size)) return edge;
  }
  return std::nullopt;
}

}  // namespace

bool same_edge(const Edge& a, const Edge& b, double reach) {
  const Point apart = a.place - b.place;
  return length_of(apart) < reach && dot(a.off, b.off) > kSameWay && dot(a.normal, b.normal) > kSameWay;
}

bool same_end(const Edge& a, const Edge& b, double reach) {
  const Point apart = a.place - b.place;
  const double sides = dot(a.normal, b.normal), behind = dot(a.normal, apart);
  if (dot(a.off, b.off) < kSameWay || std::abs(sides) < kSameWay || std::abs(dot(a.off, apart)) > reach) return false;
  return behind > -reach && behind < (sides > 0.0 ? reach : kThickest);
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
