// Poses that belong together: what odometry and scans say of how they lie to one another, and the poses that fit best.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "landmarks.hpp"
#include "pose.hpp"

namespace mr_robot::slam {

class PoseGraph {
 public:
  PoseGraph();
  ~PoseGraph();

  // The first pose stays where it is.
  void add(const Pose& pose) { poses_.push_back(pose); }
  // Odometry counted `motion` from one pose to the next one, `next`, with these standard deviations besides the factors
  // by which it counts all distances and turns wrong.
  void link_odometry(std::size_t next, const Pose& motion, const Pose& deviation);
  // What the standard deviations of the motion to `next` have turned out to be.
  void weigh_odometry(std::size_t next, const Pose& deviation) { odometry_[next - 1].deviation = deviation; }
  // Scans say that `to` lies at `relative` seen from `from`. `information`: of that, inverse of its covariance. `sure`:
  // not doubted before the poses have followed it once, however far that moves them.
  void link(std::size_t from, std::size_t to, const Pose& relative, const Eigen::Matrix3d& information,
            bool sure = false);

  // Most walls around the pose run along or across the robot at `heading` (rad, a quarter turn more or less is the
  // same). Where most walls of the building stand square to one another, they tell how the pose is turned.
  void see_walls(std::size_t pose, double heading) { walls_.push_back({pose, heading}); }

  // `edge`: in the frame of the pose.
  void see_edge(std::size_t pose, const Edge& edge) { edges_.emplace_back(pose, edge); }
  // Takes for one what lies at one place, the poses being where they are.
  void match_edges() { landmarks_ = landmarks_of(edges_, poses_); }

  // rad, less than an eighth of a turn: most walls have it or are square to it; none where they do not stand square.
  std::optional<double> direction_of_walls() const;

  std::size_t size() const { return poses_.size(); }
  const Pose& pose(std::size_t index) const { return poses_[index]; }

  // Moves the poses, in `iterations` steps at most, towards where all fits best (least squares, Cauchy weights for what
  // scans say). Returns whether they are there.
  bool solve(int iterations);
  // The same, step by step: what is added after the beginning has no say, and poses added then go along with the one
  // before. `step` returns whether they are there; `finish` takes what has been reached.
  void begin();
  bool step();
  void finish();

 private:
  class Solution;

  struct OdometryLink {
    std::size_t next;
    Pose motion, deviation;
  };
  struct Link {
    std::size_t from, to;
    Pose relative;
    Eigen::Matrix3d root;  // of the information
    bool sure;
  };

  struct Walls {
    std::size_t pose;
    double heading;
  };

  // rad off the direction that most walls have or are square to.
  double off(const Walls& walls, double direction) const;
  std::vector<Pose> poses_;
  std::vector<Walls> walls_;
  std::vector<OdometryLink> odometry_;
  std::vector<Link> links_;
  std::vector<std::pair<std::size_t, Edge>> edges_;  // in the frames of these poses
  std::vector<Landmark> landmarks_;
  double factors_[2] = {1.0, 1.0};  // of distance and turn
  std::unique_ptr<Solution> solution_;
};

}  // namespace mr_robot::slam
