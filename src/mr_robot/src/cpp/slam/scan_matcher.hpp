// Where must the robot be for its scan to lie on the surfaces of the map?
#pragma once

#include <limits>
#include <map>
#include <optional>

#include "evidence.hpp"
#include "grid_map.hpp"
#include "match_options.hpp"
#include "scan.hpp"

namespace mr_robot::slam {

enum class Outcome {
  kMatched,
  kNothingKnown,  // too little of what the scan shows has been seen before: it may enter the map at odometry's pose
  kNothingSeen,   // same, for it shows too little: it neither confirms odometry nor its opposite
  kContradicts,   // the pose is odometry's, and wrong
};

struct Match {
  Pose pose;
  double share = 0.0;  // of the hits in known parts, those that lie on a surface
  Outcome outcome = Outcome::kNothingKnown;
  // Where the scan would fit far from where odometry leads: to be believed when scans from other places say the same.
  std::optional<Pose> elsewhere = std::nullopt;
  bool stays = false;  // that is where it was: its wheels slip
  double known = 0.0;  // share of the hits that lie in known parts
  double along = 0.0;  // share of the scan, beside odometry, in what is known of the position along the heading
  std::map<int, Evidence> origins{};  // hits by the origin of the surfaces that they lie on
};

// `expected`: pose by odometry with its standard deviations, weak enough for the scan to overrule slipping wheels.
// `previous`: pose at the last match that held, where the robot still is if its wheels slipped; none if it has left.
// `sparse`: the scan comes so far from the last one that most of what it shows was seen once, and that it is looked
// for wherever odometry leaves it. `long_ago`: the last origin of what was drawn long ago, which does not steer while
// more hits lie on what was drawn lately.
Match match_scan(const GridMap& map, const Scan& scan, const Pose& expected, const Pose& deviation,
                 const std::optional<Pose>& previous, bool sparse, int long_ago, const MatchOptions& options);

// Of a robot that comes back to where it was long ago: where it must be for its scan to lie on the surfaces of `old`.
// That is `elsewhere`, within `window` (m, rad) of `pose`, where they say much more than at `pose`. Nothing where they
// say too little.
std::optional<Match> match_old(const GridMap& old, const Scan& scan, const Pose& pose, const Pose& window,
                               const MatchOptions& options);

// Scans of one frame, with its pose near `pose`: where it fits best, and how well, each scan seen from where it was
// taken. The pose is that of the frame.
Match match_place(const GridMap& map, const std::vector<Scan>& scans, const Pose& pose, const MatchOptions& options);

// Whether the hits of a match on surfaces of origins up to `last` tell its position in every direction.
bool tells_place(const Match& match, int last = std::numeric_limits<int>::max());

}  // namespace mr_robot::slam
