#include "pose_graph.hpp"

#include <ceres/autodiff_cost_function.h>
#include <ceres/jet.h>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <utility>

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
constexpr double kLeastDamping = 1e-6;  // share of what is known of a value, by which it stays where it is
constexpr double kDampingFactor = 3.0;  // by which that is changed
constexpr double kLeastGain = 1e-6;     // share of the cost, less than which is none
constexpr std::size_t kRecent = 10;     // poses back, to which scans are not doubted

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

// What is solved for, and all that is said of it. Levenberg and Marquardt's steps are taken one by one: a solver that
// is called for each anew would build and order the same equations each time, which takes longer than the step.
class PoseGraph::Solution {
 public:
  explicit Solution(const PoseGraph& graph);
  // Returns whether the poses are where all fits best.
  bool step();
  void take_to(PoseGraph* graph) const;

 private:
  static constexpr std::size_t kMostParts = 3;  // that one cost speaks of, of
  static constexpr int kMostValues = 3;         // numbers each
  struct Part {
    std::size_t first;  // of its values
    int size;
  };
  struct Term {
    std::unique_ptr<ceres::CostFunction> cost;
    bool doubted;
    std::vector<Part> parts;
  };
  struct Equations {
    Eigen::SparseMatrix<double> matrix;  // its lower half
    Eigen::VectorXd gradient;
    double cost = 0.0;
  };
  using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower>;

  static constexpr std::size_t kSteady = 3;  // values of the first pose, which stays

  template <int Residuals, int... Sizes, class Cost>
  void add(Cost* cost, bool doubted, std::initializer_list<Part> parts) {
    auto derived = std::make_unique<ceres::AutoDiffCostFunction<Cost, Residuals, Sizes...>>(cost);
    terms_.push_back({std::move(derived), doubted, parts});
  }
  static Part pose(std::size_t index) { return {3 * index, 3}; }
  Part factors() const { return {3 * poses_, 2}; }
  Part direction() const { return {3 * poses_ + 2, 1}; }
  Part landmark(std::size_t index) const { return {3 * poses_ + 3 + index, 1}; }
  Equations equations(const std::vector<double>& values) const;
  double add_term(const Term& term, const std::vector<double>& values, std::vector<Eigen::Triplet<double>>* entries,
                  Eigen::VectorXd* gradient) const;
  std::vector<double> moved_by_solution();

  std::size_t poses_;
  std::vector<Landmark> landmarks_;
  std::vector<double> values_;  // poses, factors, direction of the walls, coordinates of the landmarks
  std::vector<Term> terms_;
  Equations equations_;
  Solver solver_;
  bool ordered_ = false;
  double damping_ = kLeastDamping;
};

PoseGraph::Solution::Solution(const PoseGraph& graph) : poses_(graph.poses_.size()), landmarks_(graph.landmarks_) {
  for (const Pose& pose : graph.poses_) values_.insert(values_.end(), {pose.x, pose.y, pose.yaw});
  const std::optional<double> walls = graph.direction_of_walls();
  values_.insert(values_.end(), {graph.factors_[0], graph.factors_[1], walls.value_or(0.0)});
  for (const Landmark& landmark : landmarks_) values_.push_back(landmark.coordinate);
  for (const OdometryLink& link : graph.odometry_) {
    add<3, 3, 3, 2>(new OdometryCost{link.motion, link.deviation}, true,
                    {pose(link.next - 1), pose(link.next), factors()});
  }
  for (const Link& link : graph.links_) {
    add<3, 3, 3>(new ScanCost{link.relative, link.root}, link.from + kRecent < link.to,
                 {pose(link.from), pose(link.to)});
  }
  for (const Walls& seen : graph.walls_) {
    const double askew = walls ? graph.off(seen, *walls) : INFINITY;
    if (std::abs(askew) > kAskew) continue;
    add<1, 3, 1>(new WallsCost{askew + *walls - graph.poses_[seen.pose].yaw}, true, {pose(seen.pose), direction()});
  }
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    for (const auto& [from, edge] : landmarks_[i].seen) {
      add<1, 3, 1>(new EdgeCost{edge, landmarks_[i].off}, true, {pose(from), landmark(i)});
    }
  }
  add<2, 2>(new FactorCost, false, {factors()});
  equations_ = equations(values_);
}

// Returns what it costs.
double PoseGraph::Solution::add_term(const Term& term, const std::vector<double>& values,
                                     std::vector<Eigen::Triplet<double>>* entries, Eigen::VectorXd* gradient) const {
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, kMostValues, kMostValues>;
  double residuals[kMostValues], jacobians[kMostParts][kMostValues * kMostValues];
  const double* parameters[kMostParts];
  double* derivatives[kMostParts];
  for (std::size_t i = 0; i < term.parts.size(); ++i) {
    parameters[i] = &values[term.parts[i].first];
    derivatives[i] = jacobians[i];
  }
  term.cost->Evaluate(parameters, residuals, derivatives);
  const int count = term.cost->num_residuals();
  const Eigen::Map<const Eigen::VectorXd> residual(residuals, count);
  const double squared = residual.squaredNorm(), scaled = squared / (kOutlier * kOutlier);
  const double weight = term.doubted ? 1.0 / (1.0 + scaled) : 1.0;
  for (std::size_t i = 0; i < term.parts.size(); ++i) {
    if (term.parts[i].first < kSteady) continue;
    const auto row = static_cast<int>(term.parts[i].first - kSteady);
    const Eigen::Map<const Jacobian> left(jacobians[i], count, term.parts[i].size);
    gradient->segment(row, term.parts[i].size) += weight * left.transpose() * residual;
    for (std::size_t j = 0; j < term.parts.size(); ++j) {
      if (term.parts[j].first < kSteady || term.parts[j].first > term.parts[i].first) continue;
      const auto column = static_cast<int>(term.parts[j].first - kSteady);
      const Eigen::Map<const Jacobian> right(jacobians[j], count, term.parts[j].size);
      const Jacobian product = weight * left.transpose() * right;
      for (int r = 0; r < product.rows(); ++r) {
        for (int c = 0; c < product.cols(); ++c) {
          if (row + r >= column + c) entries->emplace_back(row + r, column + c, product(r, c));
        }
      }
    }
  }
  return 0.5 * (term.doubted ? kOutlier * kOutlier * std::log1p(scaled) : squared);
}

PoseGraph::Solution::Equations PoseGraph::Solution::equations(const std::vector<double>& values) const {
  const auto size = static_cast<int>(values.size() - kSteady);
  Equations result{Eigen::SparseMatrix<double>(size, size), Eigen::VectorXd::Zero(size)};
  std::vector<Eigen::Triplet<double>> entries;
  // What nothing is said of stays: the direction of walls that do not stand square.
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, kLeastDamping);
  for (const Term& term : terms_) result.cost += add_term(term, values, &entries, &result.gradient);
  result.matrix.setFromTriplets(entries.begin(), entries.end());
  return result;
}

std::vector<double> PoseGraph::Solution::moved_by_solution() {
  Eigen::SparseMatrix<double> damped = equations_.matrix;
  damped.diagonal() *= 1.0 + damping_;
  if (!ordered_) solver_.analyzePattern(damped);
  ordered_ = true;
  solver_.factorize(damped);
  const Eigen::VectorXd step = solver_.solve(equations_.gradient);
  std::vector<double> values = values_;
  for (std::size_t i = kSteady; i < values.size(); ++i) values[i] -= step[static_cast<long>(i - kSteady)];
  return values;
}

bool PoseGraph::Solution::step() {
  std::vector<double> values = moved_by_solution();
  Equations next = equations(values);
  const double gain = equations_.cost - next.cost;
  const bool there = std::abs(gain) <= kLeastGain * equations_.cost;
  if (gain >= 0.0) {
    values_ = std::move(values);
    equations_ = std::move(next);
    damping_ = std::max(damping_ / kDampingFactor, kLeastDamping);
  } else {
    damping_ *= kDampingFactor * kDampingFactor;
  }
  return there;
}

void PoseGraph::Solution::take_to(PoseGraph* graph) const {
  const std::size_t last = poses_ - 1;
  const Pose before = graph->poses_[last];
  for (std::size_t i = 0; i <= last; ++i) {
    const double* value = &values_[pose(i).first];
    graph->poses_[i] = {value[0], value[1], normalized(value[2])};
  }
  for (std::size_t i = last + 1; i < graph->poses_.size(); ++i) {
    graph->poses_[i] = graph->poses_[last] * between(before, graph->poses_[i]);
  }
  for (int i = 0; i < factors().size; ++i) graph->factors_[i] = values_[factors().first + i];
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
