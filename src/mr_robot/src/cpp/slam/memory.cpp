#include "memory.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <utility>

namespace mr_robot::slam {
namespace {

constexpr double kKeyframeDistance = 0.75;  // m between keyframes
constexpr double kKeyframeAngle = 0.8;      // rad
constexpr int kSolveEvery = 3;              // keyframes
constexpr int kSolutionSteps = 8;           // of a solution, one with each scan that comes, and
constexpr int kClosingSteps = 30;           // of one that moves much
constexpr std::size_t kMostLinks = 8;       // of a keyframe to others, by scans
constexpr Pose kLoopWindow{1.0, 1.0, 0.1};  // m and rad at most, within which a loop is closed
constexpr double kLeastWindow = 0.3;        // m
constexpr double kDrift = 3.0;              // deviations by which a way may have drifted,
constexpr double kTurnDrift = 0.35;         // rad, same
constexpr double kMostOld = 0.8;            // of the hits, on what was drawn long ago: the robot has come back
constexpr double kFarthestLoop = 5.0;       // m at most, within which a loop is looked for on a map of its own,
constexpr double kFarLoopTurn = 0.2;        // rad, and what is beside it:
constexpr double kBesideLoop = 8.0;         // m
constexpr int kOldAtOnce = 4;               // with each scan that comes
constexpr double kSameLoop = 0.15;          // m within which two keyframes say the same
constexpr double kMoved = 0.03;             // m that a keyframe has moved before the map is drawn anew
constexpr double kTurned = 0.005;           // rad
constexpr std::size_t kMostScans = 20'000;  // beyond, the map stays as it is

const Eigen::Matrix3d kFloor = Eigen::Vector3d(1e-4, 1e-4, 4e-6).asDiagonal();          // covariance of the best match
const Eigen::Matrix3d kLoopFloor = Eigen::Vector3d(2.5e-3, 2.5e-3, 4e-5).asDiagonal();  // of one that closes a loop

Eigen::Matrix3d with_floor(const Eigen::Matrix3d& information, const Eigen::Matrix3d& floor) {
  // Inverse of (information^-1 + floor), also where the information is singular.
  const Eigen::Matrix3d sum = Eigen::Matrix3d::Identity() + information * floor;
  const Eigen::Matrix3d result = sum.inverse() * information;
  return 0.5 * (result + result.transpose()) + 1e-3 * Eigen::Matrix3d::Identity();
}

// Information about a position in the map, as about the same position seen from a frame that is turned.
Eigen::Matrix3d seen_from(const Pose& frame, const Eigen::Matrix3d& information) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(frame.yaw).toRotationMatrix();
  return turn.transpose() * information * turn;
}

}  // namespace

Memory::Memory(const GridOptions& grid, const ScanOptions& options, Journal* journal)
    : grid_(grid), journal_(journal), keyframes_(grid, options) {}

bool Memory::due(const Pose& pose) const {
  return keyframes_.empty() || returns_ || apart(keyframes_.back().drawn, pose, kKeyframeDistance, kKeyframeAngle);
}

int Memory::origin(const Pose& pose) const { return static_cast<int>(keyframes_.size()) - (due(pose) ? 0 : 1); }

bool Memory::add(const std::vector<float>& ranges, const Scan& scan, const LaserGeometry& geometry, const Pose& pose,
                 const Pose& odometry, const Way& way, const OdometryModel& model, const Match& match) {
  if (scans_ == kMostScans) return false;
  ++scans_;
  const bool opens = due(pose);
  if (opens) open(pose, odometry, way, model, match);
  keyframes_.keep(ranges, scan, geometry, pose);
  if (journal_->kept()) journal_->write(JournalScan{opens, pose, odometry, way, geometry, ranges});
  return opens;
}

void Memory::open(const Pose& pose, const Pose& odometry, const Way& way, const OdometryModel& model,
                  const Match& match) {
  keyframes_.open(pose, odometry, way);
  const std::size_t next = keyframes_.size() - 1;
  join(next, model, returns_);
  if (next == 0) return;
  link_by_scan(next, pose, match, kFloor, returns_);
  if (std::exchange(returns_, false)) {
    closing_ = true;
    solved_ = 0;
  }
  // The correction is not to wait for more keyframes: the robot may be home, and there are none to come.
  const bool told = told_long_ago(match);
  if (told && !told_) solved_ = 0;
  if (told) anchored_ = way.distance;
  told_ = told;
}

// The next keyframe enters the graph: with all scans of the one before, what is seen from there is known.
void Memory::join(std::size_t next, const OdometryModel& model, bool drifted) {
  const Keyframe& keyframe = keyframes_[next];
  if (next == 0) {
    graph_.add(keyframe.drawn);
    return;
  }
  const Keyframe& last = keyframes_[next - 1];
  if (const auto heading = last.walls.direction()) graph_.see_walls(next - 1, *heading);
  for (const Edge& edge : last.edges.edges()) graph_.see_edge(next - 1, edge);
  const Pose motion = between(last.odometry, keyframe.odometry);
  graph_.add(graph_.pose(next - 1) * (drifted ? motion : between(last.drawn, keyframe.drawn)));
  graph_.link_odometry(next, motion, model.deviation_of_way(keyframe.way - last.way));
}

void Memory::recall(JournalScan scan) {
  if (!scan.opens && keyframes_.empty()) return;
  if (scan.opens) keyframes_.open(scan.pose, scan.odometry, scan.way);
  const Scan seen = keyframes_.scan_of(scan.ranges, scan.geometry);
  keyframes_.keep(std::move(scan.ranges), seen, scan.geometry, scan.pose);
  ++scans_;
}

void Memory::recall(std::vector<JournalEntry> entries, GridMap* map, const OdometryModel& model) {
  std::vector<JournalLink> links;
  for (JournalEntry& entry : entries) {
    if (auto* scan = std::get_if<JournalScan>(&entry)) recall(std::move(*scan));
    if (const auto* link = std::get_if<JournalLink>(&entry)) links.push_back(*link);
    if (const auto* moved = std::get_if<JournalPoses>(&entry)) {
      for (JournalLink& link : links) link.sure &= moved->closing;
      const std::size_t count = std::min(moved->poses.size(), keyframes_.size());
      for (std::size_t i = 0; i < count; ++i) keyframes_.move(i, moved->poses[i]);
    }
  }
  for (std::size_t i = 0; i < keyframes_.size(); ++i) join(i, model);
  for (const JournalLink& link : links) {
    if (std::max(link.from, link.to) >= keyframes_.size()) continue;
    graph_.link(link.from, link.to, link.relative, link.information, link.sure);
    closing_ |= link.sure;
  }
  solved_ = closing_ ? 0 : keyframes_.size();
  keyframes_.draw(map);
}

// Whether surfaces of long ago tell the position of a scan, in every direction.
bool Memory::told_long_ago(const Match& match) const { return tells_place(match, long_ago()); }

// `returns`: of what was drawn lately, which is not where the robot is, some may be hit by chance.
void Memory::link_by_scan(std::size_t next, const Pose& pose, const Match& match, const Eigen::Matrix3d& floor,
                          bool returns) {
  std::vector<std::pair<int, int>> most;  // hits on surfaces of an origin
  for (const auto& [origin, evidence] : match.origins) {
    if (!returns || origin <= long_ago()) most.emplace_back(evidence.hits, origin);
  }
  std::sort(most.rbegin(), most.rend());
  most.resize(std::min(most.size(), kMostLinks));
  for (const auto& [hits, origin] : most) {
    const Pose& from = keyframes_[origin].drawn;
    const Evidence& evidence = match.origins.at(origin);
    const Eigen::Matrix3d seen = seen_from(from, evidence.information);
    const Pose relative = between(from, moved(pose, evidence.step()));
    const Eigen::Matrix3d information = with_floor(seen, static_cast<double>(most.size()) * floor);
    graph_.link(origin, next, relative, information, returns);
    journal_->write(JournalLink{static_cast<std::size_t>(origin), next, relative, information, returns});
  }
}

bool Memory::returns(const Pose& thought, const Pose& found, const Match& match, const Way& way,
                     const OdometryModel& model) {
  keyframes_.go_on(way.distance);
  int hits = 0, old = 0;
  double since = 0.0;  // m of way, mean over the hits on what was drawn long ago
  for (const auto& [origin, evidence] : match.origins) {
    hits += evidence.hits;
    if (origin > long_ago()) continue;
    old += evidence.hits;
    since += evidence.hits * (way.distance - keyframes_[origin].way.distance);
  }
  if (old == 0 || old < kMostOld * hits) return false;
  const double drift = kDrift * model.deviation_of_way({since / old, 0.0}).y;
  returns_ = distance(thought, found) <= drift && std::abs(normalized(found.yaw - thought.yaw)) <= kTurnDrift;
  return returns_;
}

void Memory::close_loop(const OdometryModel& model, const MatchOptions& options) {
  const Keyframe& last = keyframes_.back();
  keyframes_.go_on(last.way.distance);
  if (long_ago() < 0) return;
  const double drift = kDrift * model.deviation_of_way({last.way.distance, 0.0}).x;
  const double window = std::clamp(drift, kLeastWindow, kLoopWindow.x);
  const auto match = match_old(keyframes_.drawn_around(last.drawn), keyframes_.lately(), last.drawn,
                               {window, window, kLoopWindow.yaw}, options);
  const bool here = match && !match->elsewhere;
  const bool same = match && loop_ && distance(*loop_ * last.drawn, match->pose) < kSameLoop;
  loop_.reset();
  if (match && !here) loop_ = match->pose * between(last.drawn, Pose{});
  if (here || same) link_by_scan(keyframes_.size() - 1, match->pose, *match, kLoopFloor);
  if (same && !here) solved_ = 0;
  if ((here || same) && tells_place(*match)) anchored_ = last.way.distance;
  const double since = kDrift * model.deviation_of_way({last.way.distance - anchored_, 0.0}).y;
  if (since < kLoopWindow.x) {
    far_loop_.reset();
  } else if (!far_loop_) {
    begin_far_loop(std::min(since, kFarthestLoop), options);
  } else if (far_loop_->waits()) {
    far_loop_->see(keyframes_.seen_lately(far_loop_->keyframe()));
  } else if (far_loop_->failed()) {
    far_loop_.reset();
  }
}

void Memory::begin_far_loop(double drift, const MatchOptions& options) {
  const std::size_t last = keyframes_.size() - 1;
  const Pose& here = keyframes_[last].drawn;
  to_draw_ = keyframes_.old_scans(here, 2.0 * drift + kBesideLoop);
  if (to_draw_.empty()) return;
  far_loop_.emplace(grid_, options, last, here, Pose{drift, drift, kFarLoopTurn});
  far_loop_->see(keyframes_.seen_lately(last));
}

void Memory::close_far_loop() {
  if (!far_loop_ || closing_ || returns_ || redrawing_) return;
  if (far_loop_->draws()) {
    for (int done = 0; done < kOldAtOnce && !to_draw_.empty(); ++done) {
      const auto [keyframe, scan] = to_draw_.back();
      const Kept& kept = keyframes_[keyframe].scans[scan];
      far_loop_->draw(
          {keyframes_.scan_of(kept), keyframes_[keyframe].drawn * kept.relative, static_cast<int>(keyframe)});
      to_draw_.pop_back();
    }
    if (to_draw_.empty()) far_loop_->drawn();
    return;
  }
  const std::optional<Match> match = far_loop_->work();
  if (!match) return;
  link_by_scan(far_loop_->keyframe(), match->pose, *match, kLoopFloor, true);
  far_loop_.reset();
  closing_ = true;
  solved_ = 0;
}

void Memory::begin_solving(const OdometryModel& model) {
  for (std::size_t i = 1; i < keyframes_.size(); ++i) {
    graph_.weigh_odometry(i, model.deviation_of_way(keyframes_[i].way - keyframes_[i - 1].way));
  }
  graph_.match_edges();
  graph_.begin();
  solved_ = keyframes_.size();
  iterations_ = closing_ ? kClosingSteps : kSolutionSteps;
}

void Memory::solve() {
  --iterations_;
  if (graph_.step()) iterations_ = 0;
  if (iterations_ == 0) graph_.finish();
}

void Memory::begin_redrawing(const GridMap& map) {
  bool moved = false;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) {
    moved |= distance(graph_.pose(i), keyframes_[i].drawn) > kMoved ||
             std::abs(normalized(graph_.pose(i).yaw - keyframes_[i].drawn.yaw)) > kTurned;
  }
  if (!moved) {
    closing_ = closing_ && solved_ < keyframes_.size();
    return;
  }
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) poses.push_back(graph_.pose(i));
  redrawing_.emplace(grid_, map, std::move(poses));
}

std::optional<std::pair<Pose, Pose>> Memory::work(GridMap* map, const OdometryModel& model, bool rests) {
  if (scans_ == kMostScans) return std::nullopt;
  if (!redrawing_) {
    if (iterations_ > 0) {
      solve();
      if (iterations_ == 0) begin_redrawing(*map);
    } else if (keyframes_.size() >= solved_ + (rests ? 1 : kSolveEvery)) {
      begin_solving(model);
    }
    return std::nullopt;
  }
  if (!redrawing_->step(keyframes_)) return std::nullopt;
  std::vector<Pose> targets;
  for (std::size_t i = 0; i < keyframes_.size(); ++i) targets.push_back(redrawing_->target(keyframes_, i));
  const std::pair<Pose, Pose> change{keyframes_.back().drawn, targets.back()};
  for (std::size_t i = 0; i < keyframes_.size(); ++i) keyframes_.move(i, targets[i]);
  *map = std::move(redrawing_->map());
  redrawing_.reset();
  loop_.reset();
  far_loop_.reset();
  closing_ = closing_ && solved_ < keyframes_.size();
  journal_->write(JournalPoses{closing_, std::move(targets)});
  return change;
}

}  // namespace mr_robot::slam
