#include "pose_graph.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace map_merger {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPi = 3.14159265358979323846;

double wrapped(double angle) { return angle - 2.0 * kPi * std::floor((angle + kPi) / (2.0 * kPi)); }

// The transform between two nodes and its derivatives with respect to both poses.
struct Between {
  Vector3d transform;
  Matrix3d by_first, by_second;
};

Between between(const Vector3d& first, const Vector3d& second) {
  const double cosine = std::cos(first.z()), sine = std::sin(first.z());
  const double x = second.x() - first.x(), y = second.y() - first.y();
  Between result;
  result.transform << cosine * x + sine * y, cosine * y - sine * x, wrapped(second.z() - first.z());
  result.by_second << cosine, sine, 0.0, -sine, cosine, 0.0, 0.0, 0.0, 1.0;
  result.by_first = -result.by_second;
  result.by_first(0, 2) = result.transform.y(), result.by_first(1, 2) = -result.transform.x();
  return result;
}

Vector3d difference(const Vector3d& transform, const Vector3d& mean) {
  Vector3d residual = transform - mean;
  residual.z() = wrapped(residual.z());
  return residual;
}

// The unknowns: three for each node that is not held, beginning at its place, which is -1 for a held one.
struct Unknowns {
  std::vector<Eigen::Index> place;
  Eigen::Index count = 0;
};

Unknowns unknowns_of(const std::vector<bool>& held) {
  Unknowns unknowns;
  for (const bool fixed : held) {
    unknowns.place.push_back(fixed ? -1 : unknowns.count);
    if (!fixed) unknowns.count += 3;
  }
  return unknowns;
}

struct Equations {
  MatrixXd matrix;
  VectorXd gradient;
};

Equations equations_of(const std::vector<Link>& links, const std::vector<Matrix3d>& information,
                       const std::vector<Vector3d>& poses, const Unknowns& unknowns) {
  Equations sum{MatrixXd::Zero(unknowns.count, unknowns.count), VectorXd::Zero(unknowns.count)};
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Between now = between(poses[links[i].first], poses[links[i].second]);
    const Vector3d residual = difference(now.transform, links[i].mean);
    const std::pair<Eigen::Index, const Matrix3d*> ends[] = {{unknowns.place[links[i].first], &now.by_first},
                                                             {unknowns.place[links[i].second], &now.by_second}};
    for (const auto& [row, by_row] : ends) {
      if (row < 0) continue;
      const Matrix3d weighted = by_row->transpose() * information[i];
      sum.gradient.segment<3>(row) += weighted * residual;
      for (const auto& [column, by_column] : ends)
        if (column >= 0) sum.matrix.block<3, 3>(row, column) += weighted * *by_column;
    }
  }
  return sum;
}

MatrixXd with_held(const MatrixXd& covariance, const Unknowns& unknowns) {
  const auto nodes = static_cast<Eigen::Index>(unknowns.place.size());
  MatrixXd whole = MatrixXd::Zero(3 * nodes, 3 * nodes);
  for (Eigen::Index row = 0; row < nodes; ++row) {
    for (Eigen::Index column = 0; column < nodes; ++column) {
      const Eigen::Index from_row = unknowns.place[row], from_column = unknowns.place[column];
      if (from_row >= 0 && from_column >= 0)
        whole.block<3, 3>(3 * row, 3 * column) = covariance.block<3, 3>(from_row, from_column);
    }
  }
  return whole;
}

}  // namespace

Solution solved(const std::vector<Link>& links, std::vector<Vector3d> poses, const std::vector<bool>& held, int steps,
                double small_step) {
  const Unknowns unknowns = unknowns_of(held);
  std::vector<Matrix3d> information;
  for (const Link& link : links) information.push_back(link.covariance.inverse());
  Eigen::LLT<MatrixXd> factor;
  for (int count = 0; count < steps && unknowns.count > 0; ++count) {
    const Equations equations = equations_of(links, information, poses, unknowns);
    factor.compute(equations.matrix);
    if (factor.info() != Eigen::Success) throw std::invalid_argument("the links leave a pose open");
    const VectorXd step = factor.solve(-equations.gradient);
    for (std::size_t node = 0; node < poses.size(); ++node)
      if (unknowns.place[node] >= 0) poses[node] += step.segment<3>(unknowns.place[node]);
    if (step.lpNorm<Eigen::Infinity>() < small_step) break;
  }
  for (Vector3d& pose : poses) pose.z() = wrapped(pose.z());
  MatrixXd covariance(0, 0);
  if (unknowns.count > 0) covariance = factor.solve(MatrixXd::Identity(unknowns.count, unknowns.count));
  return {std::move(poses), with_held(covariance, unknowns)};
}

std::vector<double> gaps_of(const std::vector<Link>& links, const std::vector<bool>& in_solution,
                            const Solution& solution) {
  std::vector<double> gaps;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& link = links[i];
    const Between now = between(solution.poses[link.first], solution.poses[link.second]);
    const Vector3d residual = difference(now.transform, link.mean);
    Matrix3d covariance = link.covariance;
    if (!in_solution[i]) {
      const std::pair<std::size_t, const Matrix3d*> ends[] = {{link.first, &now.by_first},
                                                              {link.second, &now.by_second}};
      for (const auto& [row, by_row] : ends)
        for (const auto& [column, by_column] : ends)
          covariance += *by_row * solution.covariance.block<3, 3>(3 * row, 3 * column) * by_column->transpose();
    }
    gaps.push_back(std::sqrt(residual.dot(covariance.lu().solve(residual))));
  }
  return gaps;
}

}  // namespace map_merger
