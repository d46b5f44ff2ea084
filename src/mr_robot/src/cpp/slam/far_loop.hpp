// A loop whose drift is larger than scans are matched over: what was seen lately is looked for on what was drawn long
// ago, drawn for itself, some work with each call.
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "grid_map.hpp"
#include "place_finder.hpp"

namespace mr_robot::slam {

class FarLoop {
 public:
  // A scan as it lies on the map, and its origin.
  struct Drawn {
    Scan scan;
    Pose robot;
    int origin;
  };

  FarLoop(const GridOptions& grid, const MatchOptions& options, std::size_t keyframe, const Pose& expected,
          const Pose& window);

  // The keyframe whose place is asked for.
  std::size_t keyframe() const { return keyframe_; }
  // Old scans are drawn until it is told that there are no more.
  bool draws() const { return !whole_; }
  void draw(const Drawn& old) { old_.insert(old.scan, old.robot, old.origin); }
  void drawn() { whole_ = true; }
  // What was seen lately, in the frame of the keyframe.
  void see(std::vector<Scan> scans);
  // Whether there is nothing to do before more is seen; and whether that is of no use.
  bool waits() const { return waits_; }
  bool failed() const { return failed_; }
  // Where the keyframe lies on what was drawn long ago, if that is sure.
  std::optional<Match> work();

 private:
  std::size_t keyframe_;
  Pose expected_, window_;
  GridMap old_;
  PlaceFinder finder_;
  std::vector<Scan> seen_;
  bool whole_ = false, begun_ = false, waits_ = false, failed_ = false;
};

}  // namespace mr_robot::slam
