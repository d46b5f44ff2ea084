#include "refinement.hpp"

#include <Eigen/Dense>
#include <cmath>

namespace map_merger {
namespace {

constexpr std::size_t kFewestPairs = 6;
constexpr double kSameFacing = 0.8660254037844387;  // cosine of 30 degrees
constexpr double kSameFacingGap = 0.52;             // length of the difference of unit vectors 30 degrees apart

struct Pair {
  OrientedPoint moved, partner;
};

std::vector<Pair> pairs_of(const SurfaceIndex& target, const std::vector<OrientedPoint>& source, const Pose& transform,
                           double reach) {
  const Frame to_target(transform);
  std::vector<Pair> pairs;
  pairs.reserve(source.size());
  for (const OrientedPoint& point : source) {
    const OrientedPoint moved = to_target * point;
    const std::ptrdiff_t partner = partner_of(target, moved, reach);
    if (partner >= 0) pairs.push_back({moved, target[partner]});
  }
  return pairs;
}

// One damped Gauss-Newton step with Cauchy weights, about the middle of the points.
Pose step_of(const std::vector<Pair>& pairs, double reach) {
  const double count = static_cast<double>(pairs.size());
  double centre_x = 0.0, centre_y = 0.0;
  for (const Pair& pair : pairs) centre_x += pair.moved.x / count, centre_y += pair.moved.y / count;
  Eigen::Matrix3d hessian = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double squared_arms = 0.0;
  for (const auto& [moved, partner] : pairs) {
    const double arm_x = moved.x - centre_x, arm_y = moved.y - centre_y;
    const double nx = partner.normal_x, ny = partner.normal_y;
    const double residual = (moved.x - partner.x) * nx + (moved.y - partner.y) * ny;
    const double scaled = residual / (0.4 * reach), weight = 1.0 / (1.0 + scaled * scaled);
    const Eigen::Vector3d jacobian(nx, ny, arm_x * ny - arm_y * nx);
    hessian += weight * jacobian * jacobian.transpose();
    gradient += weight * residual * jacobian;
    squared_arms += arm_x * arm_x + arm_y * arm_y;
  }
  hessian.diagonal() += Eigen::Vector3d(0.01 * count, 0.01 * count, 0.002 * squared_arms);
  const Eigen::Vector3d step = hessian.ldlt().solve(-gradient);
  const double yaw = mr_grid::normalized(step.z());
  const mr_grid::Point turned = Frame({0.0, 0.0, yaw}).turned({centre_x, centre_y});
  return {centre_x + step.x() - turned.x, centre_y + step.y() - turned.y, yaw};
}

}  // namespace

std::ptrdiff_t partner_of(const SurfaceIndex& target, const OrientedPoint& query, double reach) {
  const double gap = target.normal_weight() * kSameFacingGap;
  const std::ptrdiff_t number = target.nearest(query, std::sqrt(reach * reach + gap * gap));
  if (number < 0) return -1;
  const OrientedPoint& found = target[number];
  const double x = query.x - found.x, y = query.y - found.y;
  const double facing = query.normal_x * found.normal_x + query.normal_y * found.normal_y;
  return x * x + y * y <= reach * reach && facing >= kSameFacing ? number : -1;
}

Pose refined(const SurfaceIndex& target, const std::vector<OrientedPoint>& source, const Pose& start,
             const std::vector<double>& reaches) {
  Pose current = start;
  for (const double reach : reaches) {
    const std::vector<Pair> pairs = pairs_of(target, source, current, reach);
    if (pairs.size() < kFewestPairs) return current;
    const Pose step = step_of(pairs, reach);
    current = step * current;
    if (std::abs(step.x) + std::abs(step.y) < 5e-4 && std::abs(step.yaw) < 5e-5) break;
  }
  return current;
}

}  // namespace map_merger
