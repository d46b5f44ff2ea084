#include "lost.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kAstray = 1.0;         // m or rad, and
constexpr int kAstrayScans = 10;        // of a slow laser, few of which may not fit
constexpr double kNextSearch = 0.75;    // m or rad from one search to the next
constexpr double kLongestWay = 20.0;    // m that are drawn on one map
constexpr double kDrawDistance = 0.1;   // m, and
constexpr double kDrawAngle = 0.087;    // rad between scans that are drawn,
constexpr double kKeepApart = 0.3;      // m or rad, and kept
constexpr std::size_t kMostSeen = 150;  // of these scans: a robot may turn on the spot for good
constexpr int kMostContradicted = 5;    // scans in a row: the own map is wrong
constexpr std::size_t kLeastSurfaces = 100;
constexpr double kRefuted = 0.5;        // of the hits that must contradict the place where it is thought to be
constexpr double kHardlyRefuted = 0.1;  // of the hits at most, while
constexpr double kConfirmed = 0.25;     // at least lie on walls: it is there, though most of what it sees is not mapped
constexpr double kCarried = 5.0;  // m that a robot is carried: copies of rooms, where it has not been, are farther

std::vector<Feature> features_of(const GridMap& map) {
  std::vector<Feature> features;
  const Cell low = map.origin(), high{low.x + map.width() - 1, low.y + map.height() - 1};
  map.visit_surfaces(low, high, [&](const Surface& surface) {
    features.push_back({{surface.x, surface.y}, {surface.normal_x, surface.normal_y}});
  });
  return features;
}

}  // namespace

void Lost::begin_anew(const Scan& scan) {
  own_ = std::make_unique<GridMap>(grid_);
  robot_ = {};
  seen_.clear();
  way_ = searched_ = {};
  contradicted_ = 0;
  finder_.forget();
  draw(scan);
}

void Lost::draw(const Scan& scan) {
  own_->insert(scan, robot_);
  drawn_ = robot_;
  if (!seen_.empty() && !apart(kept_, robot_, kKeepApart, kKeepApart)) return;
  seen_.push_back(seen_from(robot_, scan));
  kept_ = robot_;
}

void Lost::add(const Scan& scan, const Pose& motion, const Pose& deviation) {
  ++scans_;
  if (!own_ || way_.distance > kLongestWay || seen_.size() >= kMostSeen) return begin_anew(scan);
  way_.distance += std::hypot(motion.x, motion.y);
  way_.turn += std::abs(motion.yaw);
  astray_ |= scans_ >= kAstrayScans && (way_.distance >= kAstray || way_.turn >= kAstray);
  const bool sparse = apart(Pose{}, motion, kKeepApart, kKeepApart);
  const Match match = match_scan(*own_, scan, robot_ * motion, deviation, std::nullopt, sparse, kNothingOld, options_);
  robot_ = match.pose;
  if (match.outcome == Outcome::kContradicts) {
    if (++contradicted_ >= kMostContradicted) begin_anew(scan);
    return;
  }
  contradicted_ = 0;
  if (match.outcome != Outcome::kNothingSeen && apart(drawn_, robot_, kDrawDistance, kDrawAngle)) draw(scan);
}

// Whether more has been seen than when it was last asked for.
bool Lost::due() const {
  const Way since = way_ - searched_;
  return astray_ && (since.distance >= kNextSearch || since.turn >= kNextSearch);
}

// It may be where it is thought to be, if what it has seen since fits there; and it is elsewhere, whatever looks alike,
// only if most of that does not: on ground that is not mapped a robot that has left may be all that contradicts.
std::optional<Match> Lost::begin_search(const GridMap& map, const Pose& expected) {
  const std::vector<Feature> features = features_of(*own_);
  if (features.size() < kLeastSurfaces || !finder_.prepare(map)) return std::nullopt;
  searched_ = way_;
  const Match here = match_place(map, seen_, expected * inverse(robot_), options_);
  const double confirmed = here.share * here.known, refuted = here.known - confirmed;
  const bool fits = fits_well(here) || (confirmed >= kConfirmed && refuted <= kHardlyRefuted);
  if (fits && !apart(here.pose * robot_, expected, options_.window, options_.angular_window)) return here;
  if (refuted < kRefuted) return std::nullopt;
  const double everywhere = map.resolution() * (map.width() + map.height());
  const Pose middle{(map.origin().x + 0.5 * map.width()) * map.resolution(),
                    (map.origin().y + 0.5 * map.height()) * map.resolution(), 0.0};
  finder_.begin(features, middle, {everywhere, everywhere, M_PI});
  return std::nullopt;
}

std::optional<Lost::Found> Lost::search(const GridMap& map, const Pose& expected) {
  if (!own_) return std::nullopt;
  std::optional<Match> match;
  if (!finder_.idle()) {
    match = finder_.step(map, seen_, [&](const Pose& own) { return distance(own * robot_, expected) <= kCarried; });
  } else if (due() && finder_.asks_again()) {
    searched_ = way_;
    finder_.ask_again();
  } else if (due()) {
    match = begin_search(map, expected);
  }
  if (!match) return std::nullopt;
  return Found{match->pose * robot_, *match};
}

}  // namespace mr_robot::slam
