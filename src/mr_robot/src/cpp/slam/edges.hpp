// Where surfaces end: jambs and corners. They tell the position along walls that all run one way.
#pragma once

#include <vector>

#include "scan.hpp"

namespace mr_robot::slam {

struct Edge {
  Point place;       // m
  Point off;         // unit vector along the surface, off its end
  Point normal;      // unit vector, to the side from which it was seen
  double deviation;  // m, standard, of the place along the surface
};

inline Edge operator*(const Frame& frame, const Edge& edge) {
  return {frame * edge.place, frame.turned(edge.off), frame.turned(edge.normal), edge.deviation};
}

// Whether both may be seen of one thing: within `reach`, m, and the same way round.
bool same_edge(const Edge& a, const Edge& b, double reach);

// Whether both may be of one end of a wall, perhaps seen from its two sides.
bool same_end(const Edge& a, const Edge& b, double reach);

// Ends of surfaces behind which something farther away comes into sight, in the robot's frame. What is no longer than
// `small_object_size`, m, may be a robot that drives along and has none.
std::vector<Edge> edges_of(const Scan& scan, double small_object_size);

// Edges seen from one place, each once, at the mean of where it was seen.
class KeptEdges {
 public:
  // `pose`: of the robot, seen from the place.
  void add(const Scan& scan, const Pose& pose, double small_object_size);
  std::vector<Edge> edges() const;

 private:
  struct Kept {
    Edge edge;
    int seen;
  };

  std::vector<Kept> kept_;
};

}  // namespace mr_robot::slam
