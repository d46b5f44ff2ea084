// A robot that does not know where it is on its map, as one that was carried away: it draws what it sees on a map of
// its own, until that is found on the other one.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "grid_map.hpp"
#include "odometry_model.hpp"
#include "place_finder.hpp"

namespace mr_robot::slam {

class Lost {
 public:
  struct Found {
    Pose robot;   // on the map
    Match match;  // of all that it has seen since it was lost
  };

  Lost(const GridOptions& grid, const MatchOptions& match) : grid_(grid), options_(match), finder_(match) {}

  // One more scan that does not fit where the robot is thought to be; `motion` since the one before, with its standard
  // deviations.
  void add(const Scan& scan, const Pose& motion, const Pose& deviation);
  // Whether it has gone too far for the surroundings of where it was thought to be to have it.
  bool astray() const { return astray_; }
  // A part of the search on a map. `expected`: where on it the robot is thought to be.
  std::optional<Found> search(const GridMap& map, const Pose& expected);
  // That map is another one now.
  void map_changed() { finder_.map_changed(); }

 private:
  void begin_anew(const Scan& scan);
  void draw(const Scan& scan);
  bool due() const;
  std::optional<Match> begin_search(const GridMap& map, const Pose& expected);

  GridOptions grid_;
  MatchOptions options_;
  std::unique_ptr<GridMap> own_;
  Pose robot_, drawn_, kept_;  // on that: now, and when the last scan entered it and was kept
  std::vector<Scan> seen_;     // in its frame
  Way way_, searched_;         // since it was begun; until the last search
  int contradicted_ = 0;       // scans by that, in a row
  int scans_ = 0;              // since it was lost
  bool astray_ = false;
  PlaceFinder finder_;
};

}  // namespace mr_robot::slam
