// What of a moved surface agrees with a map and what contradicts it.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "border.hpp"
#include "surface_index.hpp"

namespace map_merger {

// Numbers of points, but for the last four.
struct Comparison {
  std::int64_t inside = 0;                // on known cells of the map
  std::int64_t matched = 0;               // of these, with a like-facing partner
  std::int64_t contradicted = 0;          // of these, without partner, solid and in clear space
  double minor = 0.0;                     // smaller eigenvalue of the scatter of the matched normals
  double mean_square = 0.0;               // m^2, distance of the matched points from their partners' lines
  double middle_x = 0.0, middle_y = 0.0;  // m, of the matched points where the transform puts them
  // Sum of the products of the distances' derivatives with respect to x (m), y (m) and yaw (rad) of it: xx, xy,
  // x yaw, yy, y yaw, yaw yaw.
  std::array<double, 6> information{};
};

// `source`: a surface, moved by `transform` into the frame of the target; `solid`: which of its points may contradict.
// `known`, `clear`: cells of the target's map; the second has the geometry of the first.
Comparison compare(const SurfaceIndex& target, const Raster& known, const std::uint8_t* clear,
                   const std::vector<OrientedPoint>& source, const std::uint8_t* solid, const Pose& transform,
                   double tolerance);

}  // namespace map_merger
