// Points in the plane, n * 2 coordinates (x, y) in metres.
#pragma once

#include <cstddef>
#include <vector>

namespace explorer {

// Writes to `near` which of n points have one of the `m` places nearer than `distance`.
void near_any(const double* points, std::size_t n, const double* places, std::size_t m, double distance, bool* near);

// Indices of a subset of n points: each point left out has one of the subset within the box of half edge `distance`,
// no two of the subset lie in each other's box. First come first kept.
std::vector<std::size_t> thin(const double* points, std::size_t n, double distance);

}  // namespace explorer
