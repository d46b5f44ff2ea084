// All scans of a map, kept at places along the way of the robot that has drawn it.
#pragma once

#include <utility>
#include <vector>

#include "edges.hpp"
#include "grid_map.hpp"
#include "kept_hits.hpp"
#include "odometry_model.hpp"
#include "scan.hpp"
#include "square_walls.hpp"

namespace mr_robot::slam {

struct Kept {
  std::vector<float> ranges;
  LaserGeometry geometry;  // that of another scan may be another: of two lasers, or of one that does not turn evenly
  Pose relative;           // to the keyframe
};

struct Keyframe {
  Pose drawn;  // where it is on the map
  Pose odometry;
  Way way;
  std::vector<Kept> scans;
  KeptHits hits;
  KeptEdges edges;
  SquareWalls walls;
};

class Keyframes {
 public:
  using Place = std::pair<std::size_t, std::size_t>;  // of a scan: its keyframe, its number there

  Keyframes(const GridOptions& grid, const ScanOptions& options) : grid_(grid), options_(options) {}

  std::size_t size() const { return keyframes_.size(); }
  bool empty() const { return keyframes_.empty(); }
  const Keyframe& operator[](std::size_t number) const { return keyframes_[number]; }
  const Keyframe& back() const { return keyframes_.back(); }

  void open(const Pose& pose, const Pose& odometry, const Way& way);
  // A scan that entered the map at `pose`, at the last keyframe.
  void keep(std::vector<float> ranges, const Scan& scan, const LaserGeometry& geometry, const Pose& pose);
  // The map is drawn with the keyframe there.
  void move(std::size_t number, const Pose& drawn) { keyframes_[number].drawn = drawn; }
  Scan scan_of(const std::vector<float>& ranges, const LaserGeometry& geometry) const;
  Scan scan_of(const Kept& kept) const { return scan_of(kept.ranges, kept.geometry); }

  // The way is now that long, m.
  void go_on(double distance);
  // The last keyframe that the way since then has led far from; -1: there is none.
  int long_ago() const { return long_ago_; }

  // Throws std::length_error where the map would be larger than any map.
  void draw(GridMap* map) const;
  // What was hit on the last metres, as one scan from the last keyframe.
  Scan lately() const;
  // First scans of the last keyframes, seen from one of them.
  std::vector<Scan> seen_lately(std::size_t keyframe) const;
  // The surfaces that were hit long ago from around there.
  GridMap drawn_around(const Pose& pose) const;
  // Some scans of long ago from within so many metres.
  std::vector<Place> old_scans(const Pose& here, double within) const;

 private:
  GridOptions grid_;
  ScanOptions options_;
  std::vector<Keyframe> keyframes_;
  int long_ago_ = -1;
};

}  // namespace mr_robot::slam
