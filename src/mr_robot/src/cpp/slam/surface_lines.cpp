#include "surface_lines.hpp"

#include <algorithm>
#include <cmath>

namespace mr_robot::slam {
namespace {

constexpr int kNeighbours = 2;        // cells around a surface that make up its line
constexpr double kMatureHits = 20.0;  // of a line, for its full weight
constexpr double kMatureScans = 2.0;  // same; what was hit in one scan only, such as a robot that drives, has no weight
constexpr double kSameSide = 0.7;     // cosine
// Edges of a cell: a surface within them, in the cell of a hit or beside it, is nearer than all beyond.
constexpr double kBesideCells = 0.999;
constexpr double kSamePlace = 0.005;  // m, a hit that moves less between two iterations keeps its line

bool same_side(const Surface& surface, const Point& normal) {
  return surface.normal_x * normal.x + surface.normal_y * normal.y > kSameSide;
}

Cell around(const Cell& cell, int offset) { return {cell.x + offset, cell.y + offset}; }

// Of the surfaces in the cells up to `radius` around, within `reach`.
const Surface* nearest(const GridMap& map, const Point& point, const Point& normal, double reach, int radius) {
  const Cell center = map.cell_of(point);
  const Surface* best = nullptr;
  double best_distance = reach * reach;
  map.visit_surfaces(around(center, -radius), around(center, radius), [&](const Surface& surface) {
    const double dx = point.x - surface.x, dy = point.y - surface.y;
    const double distance = dx * dx + dy * dy;
    if (distance >= best_distance || !same_side(surface, normal)) return;
    best = &surface;
    best_distance = distance;
  });
  return best;
}

const Surface* nearest(const GridMap& map, const Point& point, const Point& normal, double reach) {
  // Mostly there is one in the cells beside, and none farther away can be nearer.
  const double beside = std::min(reach, kBesideCells * map.resolution());
  if (const Surface* found = nearest(map, point, normal, beside, 1)) return found;
  return nearest(map, point, normal, reach, static_cast<int>(std::ceil(reach / map.resolution())));
}

// The line through the nearest surface and its neighbours. A single cell would not do: a wall on the border of two
// cells leaves half its hits in each, and hits would be drawn to the nearer half wherever they lie.
Line line_near(const GridMap& map, const Point& point, const Point& normal, double reach, int long_ago) {
  const Surface* center = nearest(map, point, normal, reach);
  if (center == nullptr) return {};
  const Cell cell = map.cell_of({center->x, center->y});
  Line line;
  line.distance = length_of(point.x - center->x, point.y - center->y);
  double hits = 0.0, scans = 0.0;
  map.visit_surfaces(around(cell, -kNeighbours), around(cell, kNeighbours), [&](const Surface& surface) {
    if (!same_side(surface, normal) || (surface.origin <= long_ago) != (center->origin <= long_ago)) return;
    hits += surface.hits;
    scans += surface.hits * surface.scans;
    line.through.x += surface.hits * surface.x;
    line.through.y += surface.hits * surface.y;
    line.normal.x += surface.hits * surface.normal_x;
    line.normal.y += surface.hits * surface.normal_y;
  });
  const double length = length_of(line.normal.x, line.normal.y);
  line.through = {line.through.x / hits, line.through.y / hits};
  line.normal = {line.normal.x / length, line.normal.y / length};
  const double maturity = std::clamp((scans / hits - 1.0) / (kMatureScans - 1.0), 0.0, 1.0);
  line.density = std::min(1.0, hits / kMatureHits);
  line.weight = maturity * line.density;
  line.found = true;
  line.origin = center->origin;
  return line;
}

}  // namespace

const Line* line_of(const GridMap& map, const Point& point, const Point& normal, double reach, int long_ago,
                    Association& known) {
  const double dx = point.x - known.place.x, dy = point.y - known.place.y;
  const bool holds = dx * dx + dy * dy < kSamePlace * kSamePlace && (known.line.found || reach <= known.reach);
  if (known.reach == 0.0 || !holds) known = {point, reach, line_near(map, point, normal, reach, long_ago)};
  return known.line.found && known.line.distance < reach ? &known.line : nullptr;
}

}  // namespace mr_robot::slam
