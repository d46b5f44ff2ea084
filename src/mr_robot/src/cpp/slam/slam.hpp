// Local SLAM of one robot: odometry and scans in, pose and map out. No clock, no randomness, no I/O.
#pragma once

#include <string>
#include <string_view>

#include "grid_map.hpp"
#include "journal.hpp"
#include "lost.hpp"
#include "memory.hpp"
#include "odometry_model.hpp"
#include "scan_matcher.hpp"
#include "standing.hpp"

namespace mr_robot::slam {

struct SlamOptions {
  GridOptions grid;
  MatchOptions match;
  ScanOptions scan;
  double match_distance = 0.04;  // m by odometry after which a scan is matched
  double match_angle = 0.035;    // rad
  double insert_distance = 0.1;  // m after which a matched scan goes into the map
  double insert_angle = 0.087;   // rad
  double insert_interval = 1.0;  // s between scans of a robot that stands which change the map
};

struct SlamUpdate {
  Pose pose;              // robot in the map frame
  bool matched = false;   // the last scan did not contradict the map; otherwise odometry alone gives the pose
  bool inserted = false;  // the map that is handed out changed
  double share = 0.0;     // of the scan on known surfaces
};

// Where the robot would be if its odometry is wrong: believed when matches from different places say the same.
class Elsewhere {
 public:
  // A match that says so, or one that does not; `odometry`: the robot's. True if it is to be believed.
  bool add(const Match& match, const Pose& odometry);
  void clear() { count_ = stays_ = 0; }

 private:
  bool far_from_first(const Pose& odometry) const;

  Pose correction_;  // odometry frame in the map frame
  Pose first_;       // odometry of the first match
  int count_ = 0;
  int stays_ = 0;  // matches in a row that say that the wheels slip
};

constexpr int kReach = 1600;  // cells from the laser that are drawn: who reads the map has to bear its size

class Slam {
 public:
  explicit Slam(const SlamOptions& options);

  // `odometry`: robot in the odometry frame at the time of the scan. `time`: s, of the scan.
  SlamUpdate process(const float* ranges, std::size_t size, const LaserGeometry& geometry, const Pose& odometry,
                     double time);

  // m from the laser, from which on what is hit counts as nothing.
  double reach() const { return options_.scan.reach; }
  Pose pose_at(const Pose& odometry) const;
  // Odometry frame in the map frame.
  Pose map_to_odometry() const;

  // Where it was at the last match.
  const Pose& odometry() const { return odometry_; }

  const GridMap& map() const { return map_; }

  // So that a SLAM that is started anew goes on with this map, in this frame: from the first scan on, write what has to
  // be written; what came since; where the robot is, and what odometry is worth.
  void begin_journal() { journal_.begin(); }
  std::string take_journal() { return journal_.take(); }
  std::string state() const;
  // Goes on where a journal and a state of before ended, if they can be read; returns how much of the journal can. Only
  // before the first scan.
  std::size_t recall(std::string_view written, std::string_view state);

 private:
  void start(const Scan& scan, const Pose& odometry, double time, SlamUpdate* update);
  SlamUpdate rest(const Pose& odometry);
  SlamUpdate slip(const Scan& scan, const Pose& odometry);
  SlamUpdate go_astray(const Scan& scan, const Pose& odometry, Standing::Verdict verdict);
  bool astray() const { return lost_ && lost_->astray(); }
  void seek();
  bool insert(const Scan& scan, bool stands, double time);
  bool follow(const std::optional<std::pair<Pose, Pose>>& change);
  bool moved(const Pose& from, const Pose& to, double distance, double angle) const;

  SlamOptions options_;
  GridMap map_;
  Journal journal_;
  bool started_ = false;
  Pose pose_;                // at the last match, map frame
  Pose odometry_;            // same moment, odometry frame
  Pose driven_;              // same moment, odometry without what its wheels slipped
  Pose confirmed_;           // same frame, where the last scan was that did not contradict the map
  Pose inserted_;            // pose of the last scan in the map
  double updated_at_ = 0.0;  // s, of the last scan in the map
  int rested_ = 0;           // scans in the map since it moved
  double share_ = 1.0;       // of the last match
  Way way_;                  // by odometry, without what the wheels turned while it stood
  OdometryModel model_;
  Memory memory_;
  bool contradicted_ = false;    // by the last match
  bool left_confirmed_ = false;  // as scans say
  Elsewhere elsewhere_;
  std::optional<Lost> lost_;  // since a scan contradicted
  Standing standing_;
  Pose stood_;         // map frame, where the scan was taken that `standing_` compares with
  Pose stood_driven_;  // `driven_` at that moment
};

}  // namespace mr_robot::slam
