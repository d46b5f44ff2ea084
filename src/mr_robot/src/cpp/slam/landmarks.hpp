// Edges that were seen from several places.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "edges.hpp"

namespace mr_robot::slam {

// Of edges, only where they lie along their surface is known: a landmark is that coordinate.
struct Landmark {
  Point off;                                         // unit vector, map frame: the coordinate's direction
  double coordinate = 0.0;                           // m
  std::vector<std::pair<std::size_t, Edge>> seen{};  // from which pose, edge in the frame of that pose
};

// Edges in the order in which they were seen, each with the pose from which it was. Those that are the same on the map,
// the poses being where they are, make a landmark.
std::vector<Landmark> landmarks_of(const std::vector<std::pair<std::size_t, Edge>>& edges,
                                   const std::vector<Pose>& poses);

}  // namespace mr_robot::slam
