// Is what a robot has seen lately a place of a map, and which? Some work with each call: places where it may be, each
// looked at closely, and once more when the robot has gone on.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "place_search.hpp"
#include "scan_matcher.hpp"

namespace mr_robot::slam {

// What a scan saw from `place`, in the frame that this is given in, for `match_place`.
Scan seen_from(const Pose& place, const Scan& scan);
// Whether it is there by what the scans say, if it is known that it must be about there.
bool fits_well(const Match& match);

class PlaceFinder {
 public:
  explicit PlaceFinder(const MatchOptions& options) : options_(options) {}

  // Whether the map is ready to be searched; some of that is done with each call. It must not change from then on.
  bool prepare(const GridMap& map);
  // Within `window` (m, rad) of `centre`, of the frame that the features are given in.
  void begin(const std::vector<Feature>& features, const Pose& centre, const Pose& window);
  // One place was found: is it there as well with more that was seen?
  bool asks_again() const { return said_.has_value(); }
  void ask_again() { fits_.clear(); }
  // Whether the last question is answered.
  bool idle() const { return !search_ && fits_.size() == places_.size(); }
  // Goes on with it. `scans`: in the frame of the features; `likely`: whether that may lie there. Returns where it does
  // for sure: no other place is as good, and it was found there before.
  template <class Likely>
  std::optional<Match> step(const GridMap& map, const std::vector<Scan>& scans, Likely likely) {
    const std::optional<Match> found = step(map, scans);
    if (!found || !likely(found->pose)) {
      if (found) forget();
      return std::nullopt;
    }
    const bool again = said_ && !apart(*said_, found->pose, kSameDistance, kSameAngle);
    said_ = found->pose;
    return again ? found : std::nullopt;
  }
  void forget();
  void map_changed();

 private:
  static constexpr double kSameDistance = 0.2;  // m, and
  static constexpr double kSameAngle = 0.05;    // rad within which both say the same

  std::optional<Match> step(const GridMap& map, const std::vector<Scan>& scans);
  std::optional<Match> judge();

  MatchOptions options_;
  std::unique_ptr<SurfacePyramid> pyramid_;
  bool ready_ = false;
  std::unique_ptr<PlaceSearch> search_;
  std::vector<Pose> places_;  // that look alike
  std::vector<Match> fits_;   // at the first of these
  std::optional<Pose> said_;  // which of them it is, before the robot went on
};

}  // namespace mr_robot::slam
