#include "pose_graph.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace mr_robot::slam {
namespace {

constexpr double kFactorDeviations[2] = {0.03, 0.05};  // of odometry's factors before anything is known of them
constexpr double kOutlier = 3.0;                       // standard deviations from which scans lose their weight
constexpr double kWalls = 0.005;                       // rad, deviation of the direction that walls say, and
constexpr double kOtherWalls = 1.0;                    // how many of them off they may as well be of something askew
constexpr double kAskew = 0.2;                         // rad from which walls belong to no square building, and
constexpr double kAligned = 0.1;                       // rad within which most must be for there to be one
constexpr double kSquare = 0.7;                        // of the walls that must agree, 1: all
constexpr double kQuarter = 0.5 * M_PI;                // turn
constexpr int kMeanIterations = 8;
constexpr std::size_t kRecent = 10;  // poses back, to which scans are not doubted

template <class T>
T normalized_angle(const T& angle) {
  return ceres::atan2(ceres::sin(angle), ceres::cos(angle));
}

// Pose `to` seen from `from`, less `relative`.
template <class T>
Eigen::Matrix<T, 3, 1> difference(const T* from, const T* to, const Eigen::Matrix<T, 3, 1>& relative) {
  const T c = ceres::cos(from[2]), s = ceres::sin(from[2]), x = to[0] - from[0], y = to[1] - from[1];
  return {c * x + s * y - relative[0], -s * x + c * y - relative[1],
          normalized_angle(T(to[2] - from[2] - relative[2]))};
}

struct ScanCost {
  Pose relative;
  Eigen::Matrix3d root;

  template <class T>
  bool operator()(const T* from, const T* to, T* residual) const {
    Eigen::Map<Eigen::Matrix<T, 3, 1>> result(residual);
    result = root.cast<T>() * difference<T>(from, to, {T(relative.x), T(relative.y), T(relative.yaw)});
    return true;
  }
};

// The noise is in what odometry counted: the factors are applied to the way between the poses, or they would come out
// too small.
struct OdometryCost {
  Pose motion, deviation;

  template <class T>
  bool operator()(const T* from, const T* to, const T* factors, T* residual) const {
    const Eigen::Matrix<T, 3, 1> moved = difference<T>(from, to, {T(0.0), T(0.0), T(0.0)});
    residual[0] = (T(motion.x) - factors[0] * moved[0]) / deviation.x;
    residual[1] = (T(motion.y) - factors[0] * moved[1]) / deviation.y;
    residual[2] = normalized_angle(T(motion.yaw - factors[1] * moved[2])) / deviation.yaw;
    return true;
  }
};

// Of a heading that is known but for the direction of the building.
struct WallsCost {
  double heading;

  template <class T>
  bool operator()(const T* pose, const T* direction, T* residual) const {
    residual[0] = normalized_angle(T(pose[2] + heading - direction[0])) / kWalls;
    return true;
  }
};

struct EdgeCost {
  Edge edge;
  Point off;  // direction in which the landmark is known

  template <class T>
  bool operator()(const T* pose, const T* coordinate, T* residual) const {
    const T c = ceres::cos(pose[2]), s = ceres::sin(pose[2]);
    const T x = pose[0] + c * edge.place.x - s * edge.place.y, y = pose[1] + s * edge.place.x + c * edge.place.y;
    residual[0] = (off.x * x + off.y * y - coordinate[0]) / edge.deviation;
    return true;
  }
};

struct FactorCost {
  template <class T>
  bool operator()(const T* factors, T* residual) const {
    for (int i = 0; i < 2; ++i) residual[i] = (factors[i] - 1.0) / kFactorDeviations[i];
    return true;
  }
};

}  // namespace

void PoseGraph::link_odometry(std::size_t next, const Pose& motion, const Pose& deviation) {
  odometry_.push_back({next, motion, deviation});
}

void PoseGraph::link(std::size_t from, std::size_t to, const Pose& relative, const Eigen::Matrix3d& information,
                     bool sure) {
  links_.push_back({from, to, relative, Eigen::Matrix3d(information.llt().matrixU()), sure});
}

double PoseGraph::off(const Walls& walls, double direction) const {
  return std::remainder(poses_[walls.pose].yaw + walls.heading - direction, kQuarter);
}

std::optional<double> PoseGraph::direction_of_walls() const {
  if (walls_.empty()) return std::nullopt;
  std::complex<double> sum = 0.0;
  for (const Walls& walls : walls_) sum += std::polar(1.0, 4.0 * (poses_[walls.pose].yaw + walls.heading));
  double direction = std::arg(sum) / 4.0;
  // Of a building with an askew wing: the direction of the larger part.
  std::size_t square = 0;
  for (int iteration = 0; iteration < kMeanIterations; ++iteration) {
    double left = 0.0;
    square = 0;
    for (const Walls& walls : walls_) {
      const double away = off(walls, direction);
      if (std::abs(away) > kAligned) continue;
      left += away;
      ++square;
    }
    if (square == 0) break;
    direction += left / static_cast<double>(square);
  }
  if (static_cast<double>(square) < kSquare * static_cast<double>(walls_.size())) return std::nullopt;
  return direction;
}

// What is solved for, and all that is said of it: made once for all steps.
class PoseGraph::Solution {
 public:
  explicit Solution(const PoseGraph& graph);
  // Returns whether the poses are where all fits best.
  bool step();
  void take_to(PoseGraph* graph) const;

 private:
  // `outlier`: standard deviations from which the cost loses its weight, 0: it never does.
  template <int Residuals, int... Sizes, class Cost, class... Parts>
  void add(Cost* cost, double outlier, Parts*... parts) {
    problem_.AddResidualBlock(new ceres::AutoDiffCostFunction<Cost, Residuals, Sizes...>(cost),
                              outlier > 0.0 ? new ceres::CauchyLoss(outlier) : nullptr, parts...);
  }

  std::vector<std::array<double, 3>> poses_;
  std::array<double, 2> factors_;
  std::size_t links_;
  double direction_ = 0.0;  // of the walls
  std::vector<Landmark> landmarks_;
  ceres::Problem problem_;
  ceres::Solver::Options options_;
};

PoseGraph::Solution::Solution(const PoseGraph& graph)
    : factors_{graph.factors_[0], graph.factors_[1]}, links_(graph.links_.size()), landmarks_(graph.landmarks_) {
  for (const Pose& pose : graph.poses_) poses_.push_back({pose.x, pose.y, pose.yaw});
  for (const OdometryLink& link : graph.odometry_) {
    add<3, 3, 3, 2>(new OdometryCost{link.motion, link.deviation}, kOutlier, poses_[link.next - 1].data(),
                    poses_[link.next].data(), factors_.data());
  }
  for (const Link& link : graph.links_) {
    const bool doubted = link.from + kRecent < link.to && !link.sure;
    add<3, 3, 3>(new ScanCost{link.relative, link.root}, doubted ? kOutlier : 0.0, poses_[link.from].data(),
                 poses_[link.to].data());
  }
  const std::optional<double> walls = graph.direction_of_walls();
  direction_ = walls.value_or(0.0);
  for (const Walls& seen : graph.walls_) {
    const double askew = walls ? graph.off(seen, *walls) : INFINITY;
    if (std::abs(askew) > kAskew) continue;
    add<1, 3, 1>(new WallsCost{askew + *walls - graph.poses_[seen.pose].yaw}, kOtherWalls, poses_[seen.pose].data(),
                 &direction_);
  }
  for (Landmark& landmark : landmarks_) {
    for (const auto& [pose, edge] : landmark.seen) {
      add<1, 3, 1>(new EdgeCost{edge, landmark.off}, kOutlier, poses_[pose].data(), &landmark.coordinate);
    }
  }
  add<2, 2>(new FactorCost, 0.0, factors_.data());
  problem_.SetParameterBlockConstant(poses_[0].data());
  options_.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // SuiteSparse would run OpenMP threads, which hang in a process that was forked after they had started, and a BLAS
  // that rounds as the processor likes.
  options_.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options_.max_num_iterations = 1;
  options_.num_threads = 1;
  options_.logging_type = ceres::SILENT;
}

bool PoseGraph::Solution::step() {
  ceres::Solver::Summary summary;
  ceres::Solve(options_, &problem_, &summary);
  // The next step goes on with what this one has found of how far the costs can be trusted.
  if (!summary.iterations.empty()) options_.initial_trust_region_radius = summary.iterations.back().trust_region_radius;
  return summary.termination_type == ceres::CONVERGENCE;
}

void PoseGraph::Solution::take_to(PoseGraph* graph) const {
  const std::size_t last = poses_.size() - 1;
  const Pose before = graph->poses_[last];
  for (std::size_t i = 0; i <= last; ++i) {
    graph->poses_[i] = {poses_[i][0], poses_[i][1], normalized(poses_[i][2])};
  }
  for (std::size_t i = last + 1; i < graph->poses_.size(); ++i) {
    graph->poses_[i] = graph->poses_[last] * between(before, graph->poses_[i]);
  }
  std::copy(factors_.begin(), factors_.end(), graph->factors_);
  for (std::size_t i = 0; i < links_; ++i) graph->links_[i].sure = false;
}

PoseGraph::PoseGraph() = default;
PoseGraph::~PoseGraph() = default;

void PoseGraph::begin() { solution_ = poses_.size() < 2 ? nullptr : std::make_unique<Solution>(*this); }

bool PoseGraph::step() { return !solution_ || solution_->step(); }

void PoseGraph::finish() {
  if (solution_) solution_->take_to(this);
  solution_.reset();
}

bool PoseGraph::solve(int iterations) {
  begin();
  bool there = false;
  for (int i = 0; i < iterations && !there; ++i) there = step();
  finish();
  return there;
}

}  // namespace mr_robot::slam
