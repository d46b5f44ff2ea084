#include "slam.hpp"

#include <cstring>

namespace mr_robot::slam {
namespace {

// Scans of a robot that stands which enter the map; the next ones only take from it. Hits that err by turns into one
// cell and into the next would make thick walls.
constexpr int kRestLimit = 3;
constexpr int kStays = 2;                   // matches in a row for which the wheels have slipped
constexpr int kSayTheSame = 8;              // matches that bring the robot elsewhere
constexpr Pose kSlipped{0.03, 0.03, 0.03};  // m and rad, deviations from where the robot stood when its wheels slipped
constexpr double kSparseDistance = 0.3;     // m from one scan to the next, from where on most walls are seen once
constexpr double kSparseAngle = 0.3;        // rad, same
constexpr double kMostBlind = 0.6;          // m or rad without a scan that says anything, after which it has moved
constexpr double kSameDistance = 0.1;       // m within which they say the same
constexpr double kSameAngle = 0.05;         // rad
constexpr double kOtherDistance = 0.4;      // m from the first to the last
constexpr double kOtherAngle = 0.7;         // rad

// Where the robot is, as members of `Slam`.
struct State {
  Pose pose, odometry, driven;
  Way way;
  double updated_at;
  OdometryModel model;
};

bool near(const Pose& a, const Pose& b) {
  return slam::distance(a, b) < kSameDistance && std::abs(normalized(a.yaw - b.yaw)) < kSameAngle;
}

SlamOptions with_reach(SlamOptions options) {
  options.scan.reach = kReach * options.grid.resolution;
  return options;
}

}  // namespace

bool Elsewhere::far_from_first(const Pose& odometry) const {
  return slam::distance(first_, odometry) > kOtherDistance ||
         std::abs(normalized(odometry.yaw - first_.yaw)) > kOtherAngle;
}

bool Elsewhere::add(const Match& match, const Pose& odometry) {
  stays_ = match.elsewhere && match.stays ? stays_ + 1 : 0;
  if (!match.elsewhere) return false;
  const bool same = count_ > 0 && near(*match.elsewhere, correction_ * odometry);
  if (!same) first_ = odometry;
  count_ = same ? count_ + 1 : 1;
  correction_ = *match.elsewhere * between(odometry, Pose{});
  return stays_ >= kStays || (count_ >= kSayTheSame && far_from_first(odometry));
}

Slam::Slam(const SlamOptions& options)
    : options_(with_reach(options)), map_(options_.grid), memory_(options_.grid, options_.scan, &journal_) {}

bool Slam::moved(const Pose& from, const Pose& to, double distance, double angle) const {
  // A whisker below the threshold, so that steps of exactly that length count.
  return slam::distance(from, to) >= distance - 1e-4 || std::abs(normalized(to.yaw - from.yaw)) >= angle - 1e-4;
}

Pose Slam::pose_at(const Pose& odometry) const {
  return started_ ? pose_ * model_.corrected(between(odometry_, odometry)) : Pose{};
}

Pose Slam::map_to_odometry() const { return pose_ * between(odometry_, Pose{}); }

std::string Slam::state() const {
  const State state{pose_, odometry_, driven_, way_, updated_at_, model_};
  return {reinterpret_cast<const char*>(&state), sizeof(state)};
}

std::size_t Slam::recall(std::string_view written, std::string_view kept) {
  State state{};
  std::size_t used = 0;
  if (started_ || kept.size() != sizeof(state)) return used;
  std::memcpy(&state, kept.data(), sizeof(state));
  const Pose corrected = state.model.corrected({1.0, 1.0, 1.0}), deviation = state.model.deviation_of_way({1.0, 1.0});
  for (const Pose& pose : {state.pose, state.odometry, state.driven, corrected, deviation}) {
    if (!std::isfinite(pose.x + pose.y + pose.yaw)) return used;
  }
  memory_.recall(entries_of(written, &used), &map_, state.model);
  if (memory_.empty()) return 0;
  model_ = state.model;
  model_.interrupt();
  pose_ = confirmed_ = inserted_ = stood_ = state.pose;
  odometry_ = state.odometry;
  driven_ = stood_driven_ = state.driven;
  way_ = state.way;
  updated_at_ = state.updated_at;
  started_ = true;
  return used;
}

// Returns whether that changed the map.
bool Slam::insert(const Scan& scan, bool stands, double time) {
  rested_ = stands ? rested_ + 1 : 0;
  inserted_ = pose_;
  updated_at_ = time;
  return map_.insert(scan, pose_, memory_.origin(pose_));
}

void Slam::start(const Scan& scan, const Pose& odometry, double time, SlamUpdate* update) {
  insert(scan, false, time);
  odometry_ = odometry;
  started_ = true;
  update->matched = update->inserted = true;
  update->share = 1.0;
}

// Time to put in order what is known.
SlamUpdate Slam::rest(const Pose& odometry) {
  SlamUpdate update;
  if (astray()) seek();
  update.inserted = follow(memory_.work(&map_, model_, rested_ > 0));
  update.pose = pose_at(odometry);
  update.matched = !contradicted_;
  update.share = share_;
  return update;
}

// The wheels turned and the robot moved by no more than it may have done before they slipped.
SlamUpdate Slam::slip(const Scan& scan, const Pose& odometry) {
  if (astray()) {
    pose_ = stood_;
    odometry_ = odometry;
    driven_ = stood_driven_;
    return rest(odometry);
  }
  const Match match = match_scan(map_, scan, stood_, kSlipped, stood_, false, memory_.long_ago(), options_.match);
  pose_ = confirmed_ = match.outcome == Outcome::kMatched ? match.pose : stood_;
  odometry_ = odometry;
  driven_ = stood_driven_;
  contradicted_ = left_confirmed_ = false;
  elsewhere_.clear();
  lost_.reset();
  model_.interrupt();
  return rest(odometry);
}

// What fits now may do so by chance: nothing is drawn before all that was seen since is found on the map.
SlamUpdate Slam::go_astray(const Scan& scan, const Pose& odometry, Standing::Verdict verdict) {
  const Pose motion = between(odometry_, odometry);
  lost_->add(scan, model_.corrected(motion), model_.deviation(motion));
  pose_ = pose_at(odometry);
  driven_ = driven_ * motion;
  odometry_ = odometry;
  contradicted_ = true;
  if (verdict == Standing::Verdict::kMoved || verdict == Standing::Verdict::kUnknown) {
    stood_ = pose_;
    stood_driven_ = driven_;
  }
  return rest(odometry);
}

void Slam::seek() {
  const std::optional<Lost::Found> found = lost_->search(map_, pose_);
  if (!found) return;
  // Where it was carried, its wheels have not counted the way.
  if (!memory_.returns(pose_, found->robot, found->match, way_, model_))
    driven_ = driven_ * between(pose_, found->robot);
  pose_ = confirmed_ = stood_ = found->robot;
  stood_driven_ = driven_;
  contradicted_ = left_confirmed_ = false;
  elsewhere_.clear();
  lost_.reset();
  model_.interrupt();
}

// The map has been drawn anew: what lay at the first pose lies at the second.
bool Slam::follow(const std::optional<std::pair<Pose, Pose>>& change) {
  if (!change) return false;
  for (Pose* pose : {&pose_, &confirmed_, &inserted_, &stood_}) *pose = change->second * between(change->first, *pose);
  elsewhere_.clear();
  if (lost_) lost_->map_changed();
  return true;
}

SlamUpdate Slam::process(const float* ranges, std::size_t size, const LaserGeometry& geometry, const Pose& odometry,
                         double time) {
  const bool stands = started_ && !moved(odometry_, odometry, options_.match_distance, options_.match_angle);
  // What has left while the robot stood must not stay in the map: it may be all that keeps the robot standing.
  const bool due = !contradicted_ && std::abs(time - updated_at_) >= options_.insert_interval;
  if (stands && !due) return rest(odometry);
  const Scan scan = make_scan(ranges, size, geometry, options_.scan);
  SlamUpdate update;
  if (stands && rested_ >= kRestLimit) {
    update = rest(odometry);
    // One that was lifted and put down elsewhere sees through walls.
    const Match match = match_scan(map_, scan, update.pose, model_.deviation({}), std::nullopt, false,
                                   memory_.long_ago(), options_.match);
    if (match.outcome != Outcome::kContradicts) update.inserted |= map_.clear(scan, update.pose);
    updated_at_ = time;
    return update;
  }
  if (!started_) {
    start(scan, odometry, time, &update);
    memory_.add({ranges, ranges + size}, scan, geometry, pose_, driven_, way_, model_, Match{});
    standing_.judge(ranges, size, geometry, scan, odometry);
    return update;
  }
  const Standing::Verdict verdict = standing_.judge(ranges, size, geometry, scan, odometry);
  if (verdict == Standing::Verdict::kStands) return slip(scan, odometry);
  const Pose motion = between(odometry_, odometry);
  way_.distance += std::hypot(motion.x, motion.y);
  way_.turn += std::abs(motion.yaw);
  if (astray()) return go_astray(scan, odometry, verdict);
  left_confirmed_ |= verdict == Standing::Verdict::kMoved;
  const std::optional<Pose> previous = left_confirmed_ ? std::nullopt : std::optional(confirmed_);
  const bool turns_at_first = memory_.young() && std::abs(motion.yaw) >= options_.match_angle;
  const bool sparse = turns_at_first || moved(Pose{}, motion, kSparseDistance, kSparseAngle);
  const Match match = match_scan(map_, scan, pose_at(odometry), model_.deviation(motion), previous, sparse,
                                 memory_.long_ago(), options_.match);
  const bool doubtful = verdict == Standing::Verdict::kSeemsToStand;
  if (match.outcome == Outcome::kMatched && !doubtful && !match.elsewhere && match.share > options_.match.good_share) {
    model_.learn(motion, between(pose_, match.pose), match.along);
  } else {
    model_.interrupt();
  }
  driven_ = doubtful ? stood_driven_ * between(stood_, match.pose) : driven_ * motion;
  pose_ = match.pose;
  odometry_ = odometry;
  const bool seen = match.outcome != Outcome::kNothingSeen;
  if (seen) contradicted_ = match.outcome == Outcome::kContradicts;
  if (!contradicted_) lost_.reset();
  if (contradicted_ && !lost_) lost_.emplace(options_.grid, options_.match);
  if (lost_) lost_->add(scan, model_.corrected(motion), model_.deviation(motion));
  if (seen && elsewhere_.add(match, odometry)) {
    driven_ = driven_ * between(pose_, *match.elsewhere);
    pose_ = *match.elsewhere;
    contradicted_ = false;
    elsewhere_.clear();
    lost_.reset();
  }
  const bool says = seen || verdict == Standing::Verdict::kMoved || moved(confirmed_, pose_, kMostBlind, kMostBlind);
  if (!contradicted_ && says) {
    confirmed_ = pose_;
    left_confirmed_ = false;
  }
  bool costly = false;  // already: the rest of the work is left to the next scans
  if (!contradicted_ && !doubtful && !match.elsewhere && memory_.takes(match) &&
      (stands || moved(inserted_, pose_, options_.insert_distance, options_.insert_angle))) {
    const int width = map_.width(), height = map_.height();
    update.inserted = insert(scan, stands, time);
    costly = map_.width() != width || map_.height() != height;
    if (memory_.add({ranges, ranges + size}, scan, geometry, pose_, driven_, way_, model_, match)) {
      memory_.close_loop(model_, options_.match);
      costly = true;
    }
  }
  if (verdict == Standing::Verdict::kMoved || verdict == Standing::Verdict::kUnknown) {
    stood_ = pose_;
    stood_driven_ = driven_;
  }
  if (!costly) {
    memory_.close_far_loop();
    update.inserted |= follow(memory_.work(&map_, model_, false));
  }
  update.pose = pose_;
  update.matched = !contradicted_;
  update.share = share_ = match.share;
  return update;
}

}  // namespace mr_robot::slam
