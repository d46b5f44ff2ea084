// Local refinement of a transform: iterated closest surfaces, point to line (Chen and Medioni 1991).
#pragma once

#include <vector>

#include "surface_index.hpp"

namespace map_merger {

// Number of the point of `target` nearest to `query` if it lies within `reach` (m) and faces the same way, else -1.
std::ptrdiff_t partner_of(const SurfaceIndex& target, const OrientedPoint& query, double reach);

// The transform source -> target near `start` that lays like-facing surfaces on one another; `reaches`: search
// distances in metres, one per iteration. Directions that the surfaces do not determine (along a lone corridor) keep
// their start value.
Pose refined(const SurfaceIndex& target, const std::vector<OrientedPoint>& source, const Pose& start,
             const std::vector<double>& reaches);

}  // namespace map_merger
