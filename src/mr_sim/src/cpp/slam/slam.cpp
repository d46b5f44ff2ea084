#include "slam.hpp"

namespace mr_sim::slam {
namespace {

// Odometry alone carries the robot over this many refused scans; then the map has to follow.
constexpr int kRefusedLimit = 20;
// Scans of a robot that stands which enter the map; the next ones only take from it. Hits that err by turns into one
// cell and into the next would make thick walls.
constexpr int kRestLimit = 3;

}  // namespace

Slam::Slam(const SlamOptions& options) : options_(options), map_(options.grid) {}

bool Slam::moved(const Pose& from, const Pose& to, double distance, double angle) const {
  // A whisker below the threshold, so that steps of exactly that length count.
  return slam::distance(from, to) >= distance - 1e-4 || std::abs(normalized(to.yaw - from.yaw)) >= angle - 1e-4;
}

Pose Slam::pose_at(const Pose& odometry) const { return started_ ? pose_ * between(odometry_, odometry) : Pose{}; }

Pose Slam::map_to_odometry() const { return pose_ * between(odometry_, Pose{}); }

// Returns whether that changed the map.
bool Slam::insert(const Scan& scan, bool stands, double time) {
  rested_ = stands ? rested_ + 1 : 0;
  inserted_ = pose_;
  updated_at_ = time;
  return map_.insert(scan, pose_);
}

void Slam::start(const Scan& scan, const Pose& odometry, double time, SlamUpdate* update) {
  insert(scan, false, time);
  odometry_ = odometry;
  started_ = true;
  update->matched = update->inserted = true;
  update->share = 1.0;
}

SlamUpdate Slam::rest(const Pose& odometry) const {
  SlamUpdate update;
  update.pose = pose_at(odometry);
  update.matched = refused_ == 0;
  update.share = share_;
  return update;
}

SlamUpdate Slam::process(const float* ranges, std::size_t size, const LaserGeometry& geometry, const Pose& odometry,
                         double time) {
  const bool stands = started_ && !moved(odometry_, odometry, options_.match_distance, options_.match_angle);
  // What has left while the robot stood must not stay in the map: it may be all that keeps the robot standing.
  const bool due = refused_ == 0 && std::abs(time - updated_at_) >= options_.insert_interval;
  if (stands && !due) return rest(odometry);
  const Scan scan = make_scan(ranges, size, geometry, options_.surface_window, options_.small_object_size);
  SlamUpdate update;
  if (stands && rested_ >= kRestLimit) {
    update = rest(odometry);
    update.inserted = map_.clear(scan, update.pose);
    updated_at_ = time;
    return update;
  }
  if (!started_) {
    start(scan, odometry, time, &update);
    return update;
  }
  const Pose motion = between(odometry_, odometry);
  const double driven = std::hypot(motion.x, motion.y);
  const Pose deviation{0.02 + 0.5 * driven, 0.02 + 0.5 * driven, 0.0003 + 0.2 * std::abs(motion.yaw)};
  const Match match = match_scan(map_, scan, pose_at(odometry), deviation, pose_, options_.match);
  pose_ = match.pose;
  odometry_ = odometry;
  refused_ = match.accepted ? 0 : refused_ + 1;
  if ((stands || moved(inserted_, pose_, options_.insert_distance, options_.insert_angle)) &&
      (match.accepted || refused_ > kRefusedLimit)) {
    update.inserted = insert(scan, stands, time);
  }
  update.pose = pose_;
  update.matched = match.accepted;
  update.share = share_ = match.share;
  return update;
}

}  // namespace mr_sim::slam
