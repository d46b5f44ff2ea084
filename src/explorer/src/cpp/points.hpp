// Points in the plane, n * 2 coordinates (x, y) in metres, and graphs over them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace explorer {

// Writes to `near` which of n points have one of the `m` places nearer than `distance`.
void near_any(const double* points, std::size_t n, const double* places, std::size_t m, double distance, bool* near);

// The same for places no farther than `distance`.
void within_any(const double* points, std::size_t n, const double* places, std::size_t m, double distance,
                bool* within);

// Writes to `nearest` which of the `m` places is the nearest to each of n points, the first of several; -1 where none
// is nearer than `distance`.
void nearest_near(const double* points, std::size_t n, const double* places, std::size_t m, double distance,
                  std::int64_t* nearest);

// Indices of a subset of n points: each point left out has one of the subset within the box of half edge `distance`,
// no two of the subset lie in each other's box. First come first kept.
std::vector<std::size_t> thin(const double* points, std::size_t n, double distance);

// The number from 0 on of the part of a graph that each of n nodes belongs to, in the order of their first nodes;
// `edges`: m * 2 nodes.
std::vector<std::int64_t> components(std::size_t n, const std::int64_t* edges, std::size_t m);

}  // namespace explorer
