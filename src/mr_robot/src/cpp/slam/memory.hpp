// All scans of the map, kept at places along the way (keyframes), so that it can be drawn anew when the way turns out
// to be another. A keyframe is linked to those on whose surfaces its first scan lies: to old ones where a loop closes.
#pragma once

#include <optional>
#include <vector>

#include "far_loop.hpp"
#include "grid_map.hpp"
#include "journal.hpp"
#include "keyframes.hpp"
#include "odometry_model.hpp"
#include "pose_graph.hpp"
#include "redrawing.hpp"
#include "scan_matcher.hpp"

namespace mr_robot::slam {

class Memory {
 public:
  // `journal`: where what is to be recalled is written; it outlives this.
  Memory(const GridOptions& grid, const ScanOptions& options, Journal* journal);

  // Becomes what it was when that was written, and draws the map. Only before anything has been added. Throws
  // std::length_error where that would be larger than any map.
  void recall(std::vector<JournalEntry> entries, GridMap* map, const OdometryModel& model);
  bool empty() const { return keyframes_.empty(); }
  // Whether all walls were seen once.
  bool young() const { return scans_ == 1; }

  // By what the surfaces of the scan that is added next are to be known.
  int origin(const Pose& pose) const;
  // The last of what was drawn long ago; -1: nothing was.
  int long_ago() const { return keyframes_.long_ago(); }
  // A scan, made of `ranges`, has entered the map at `pose`, where `match` has put it. `odometry`: without what its
  // wheels slipped. `way`: of the robot since its start. Returns whether that is a new keyframe.
  bool add(const std::vector<float>& ranges, const Scan& scan, const LaserGeometry& geometry, const Pose& pose,
           const Pose& odometry, const Way& way, const OdometryModel& model, const Match& match);
  // Whether what was seen lately, up to the new keyframe, lies elsewhere on what was drawn long ago: links the keyframe
  // there when the one before has said the same.
  void close_loop(const OdometryModel& model, const MatchOptions& options);
  // A part of the search for one that closes farther off.
  void close_far_loop();
  // The robot, lost at `thought`, has been found at `found` by `match`. Returns whether that is by how much its way may
  // have drifted since it was there: then the next scan that enters the map closes the loop.
  bool returns(const Pose& thought, const Pose& found, const Match& match, const Way& way, const OdometryModel& model);
  // Whether a scan may enter the map: while a loop is being closed, none but the one that closes it.
  bool takes(const Match& match) const { return returns_ ? told_long_ago(match) : !closing_; }
  // A part of the work that is left. When the map has been drawn anew it is moved to `map`; how the robot's pose on the
  // former map is to be taken to it. `rests`: the robot stands, so that even a little is worth a solution.
  std::optional<std::pair<Pose, Pose>> work(GridMap* map, const OdometryModel& model, bool rests);

 private:
  void open(const Pose& pose, const Pose& odometry, const Way& way, const OdometryModel& model, const Match& match);
  void join(std::size_t next, const OdometryModel& model, bool drifted = false);
  void recall(JournalScan scan);
  void link_by_scan(std::size_t next, const Pose& pose, const Match& match, const Eigen::Matrix3d& floor,
                    bool returns = false);
  bool told_long_ago(const Match& match) const;
  void begin_far_loop(double drift, const MatchOptions& options);
  bool due(const Pose& pose) const;
  void begin_solving(const OdometryModel& model);
  void solve();
  void begin_redrawing(const GridMap& map);

  GridOptions grid_;
  Journal* journal_;
  PoseGraph graph_;
  Keyframes keyframes_;
  std::optional<Redrawing> redrawing_;
  bool told_ = false;      // surfaces of long ago told the position of the last keyframe
  bool returns_ = false;   // with the next scan: the map where it is was drawn long ago, and is off
  bool closing_ = false;   // until the map has been drawn anew after that
  double anchored_ = 0.0;  // m of way when surfaces of long ago last told where the robot is
  std::optional<FarLoop> far_loop_;
  std::vector<Keyframes::Place> to_draw_;  // for that
  std::optional<Pose> loop_;  // what the last keyframe says: the frame of its drawn pose in that of the old surfaces
  std::size_t solved_ = 0;    // keyframes when the last solution was begun
  int iterations_ = 0;        // left of it
  std::size_t scans_ = 0;
};

}  // namespace mr_robot::slam
