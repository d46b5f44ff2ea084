#include "pose_graph.hpp"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <complex>

namespace mr_robot::slam {
namespace {

constexpr double kFactorDeviations[2] = {0.03, 0.05};  // of odometry's factors before anything is known of them
constexpr double kOutlier = 3.0;                       // standard deviations from which scans lose their weight
constexpr double kWalls = 0.005;                       // rad, deviation of the direction that walls say
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

void PoseGraph::link(std::size_t from, std::size_t to, const Pose& relative, const Eigen::Matrix3d& information) {
  links_.push_back({from, to, relative, Eigen::Matrix3d(information.llt().matrixU())});
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

bool PoseGraph::solve(int iterations) {
  if (poses_.size() < 2) return true;
  std::vector<std::array<double, 3>> values;
  for (const Pose& pose : poses_) values.push_back({pose.x, pose.y, pose.yaw});
  ceres::Problem problem;
  for (const OdometryLink& link : odometry_) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<OdometryCost, 3, 3, 3, 2>(new OdometryCost{link.motion, link.deviation}),
        new ceres::CauchyLoss(kOutlier), values[link.next - 1].data(), values[link.next].data(), factors_);
  }
  for (const Link& link : links_) {
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<ScanCost, 3, 3, 3>(new ScanCost{link.relative, link.root}),
                             link.from + kRecent >= link.to ? nullptr : new ceres::CauchyLoss(kOutlier),
                             values[link.from].data(), values[link.to].data());
  }
  std::optional<double> direction = direction_of_walls();
  for (std::size_t i = 0; direction && i < walls_.size(); ++i) {
    const double askew = off(walls_[i], *direction);
    if (std::abs(askew) > kAskew) continue;
    const std::size_t pose = walls_[i].pose;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<WallsCost, 1, 3, 1>(new WallsCost{askew + *direction - poses_[pose].yaw}),
        new ceres::CauchyLoss(kOutlier), values[pose].data(), &*direction);
  }
  for (Landmark& landmark : landmarks_) {
    for (const auto& [pose, edge] : landmark.seen) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<EdgeCost, 1, 3, 1>(new EdgeCost{edge, landmark.off}),
                               new ceres::CauchyLoss(kOutlier), values[pose].data(), &landmark.coordinate);
    }
  }
  problem.AddResidualBlock(new ceres::AutoDiffCostFunction<FactorCost, 2, 2>(new FactorCost), nullptr, factors_);
  problem.SetParameterBlockConstant(values[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  // SuiteSparse would run OpenMP threads, which hang in a process that was forked after they had started, and a BLAS
  // that rounds as the processor likes.
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  for (std::size_t i = 0; i < poses_.size(); ++i) poses_[i] = {values[i][0], values[i][1], normalized(values[i][2])};
  return summary.termination_type == ceres::CONVERGENCE;
}

}  // namespace mr_robot::slam
