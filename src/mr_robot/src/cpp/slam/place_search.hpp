// Where on a map may this have been seen? Branch and bound over all places and headings (Hess, Kohler, Rapp and Andor,
// Real-time loop closure in 2D lidar SLAM, 2016), a part with each call, and which other places look alike.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "surface_pyramid.hpp"

namespace mr_robot::slam {

// What is looked for: a point of a surface and its normal, in a frame whose place on the map is wanted.
struct Feature {
  Point at, normal;
};

class PlaceSearch {
 public:
  struct Place {
    Pose pose;     // of the features' frame on the map
    double share;  // of the features that lie on surfaces, 0 to 1
  };

  // Within `window` (m, rad; half widths) of `centre`.
  PlaceSearch(const SurfacePyramid& map, const std::vector<Feature>& features, const Pose& centre, const Pose& window);
  // A part of the work. Returns whether that was all.
  bool step();
  // Best first, none beside a better one; none where too many look alike to tell in bounded time.
  std::vector<Place> places() const;

 private:
  struct Square {
    int level, column, row;  // of the frame, its lower left cell
    int count;               // of features, at most, for a frame in it
  };
  struct Hit {
    int column, row;
    std::uint8_t facing;
  };

  bool turn();
  void split(const Square& square);
  void keep(const Square& square);
  int count(int level, int column, int row);
  int least() const;

  const SurfacePyramid& map_;
  std::vector<Feature> features_;
  Pose centre_;
  double turn_step_;
  int turns_, next_turn_ = 0;  // both ways, of the next heading
  int low_x_, low_y_, high_x_, high_y_;
  double heading_ = 0.0;
  std::vector<Hit> hits_;  // with that heading
  std::vector<Square> squares_;
  std::vector<Place> places_;
  int best_ = 0;     // features
  long looked_ = 0;  // at cells
};

}  // namespace mr_robot::slam
