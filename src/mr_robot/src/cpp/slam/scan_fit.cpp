#include "scan_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace mr_robot::slam {
namespace {

constexpr int kIterations = 12;
constexpr double kOnSurface = 0.05;    // m
constexpr double kReachAtLast = 0.12;  // m, how far from a surface a hit may be when the pose is nearly found
// What hits say of the position where they say least of it, 1: as much as where they say most. Below this it is noise.
constexpr double kNoise = 0.005;
constexpr double kTangential = 0.08;  // m, a surface reaches this far beside its mean

// Takes from what hits say of a pose what is noise. Walls that all run one way say nothing of the position along them
// (degenerate directions: Zhang, Kaess and Singh 2016); the normals at jambs and niches lean by how they were looked
// at, and would carry the robot along.
Eigen::Matrix3d telling_part(const Eigen::Matrix3d& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(Eigen::Matrix2d(information.topLeftCorner<2, 2>()));
  const double least = solver.eigenvalues()(0), most = solver.eigenvalues()(1);
  Eigen::Matrix3d part = Eigen::Matrix3d::Identity();
  if (most <= 0.0) return part;
  const double telling = std::clamp((least / most - kNoise) / (kTelling - kNoise), 0.0, 1.0);
  const Eigen::Vector2d along = solver.eigenvectors().col(0);
  part.topLeftCorner<2, 2>() -= (1.0 - std::sqrt(telling)) * along * along.transpose();
  return part;
}

void drop_noise(std::map<int, Evidence>* origins) {
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  for (const auto& [origin, evidence] : *origins) all += evidence.information;
  const Eigen::Matrix3d part = telling_part(all);
  for (auto& [origin, evidence] : *origins) {
    evidence.information = part * evidence.information * part;
    evidence.pull = part * evidence.pull;
  }
}

// A hit that lies on no surface: whether the map knows better.
bool contradicts(const GridMap& map, const Point& eye, const Point& point) {
  const Cell cell = map.cell_of(point);
  return (map.known(cell) && !map.hit_beside(cell)) || map.blocked(eye, point);
}

// What the map says to the hits at the pose of the fit.
void judge(const Surroundings& around, double reach, double precision, bool fresh,
           std::vector<Association>& associations, Fit* fit) {
  const auto& [map, beams, eye, long_ago] = around;
  const Frame frame(fit->pose);
  const Point from = frame * eye;
  int on_surface = 0, against = 0;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const Point point = frame * beams[i]->end;
    const Line* line = line_of(map, point, frame.turned(beams[i]->normal), reach, long_ago, associations[i]);
    bool on = false;
    double residual = 0.0;
    if (line != nullptr) {
      const double dx = point.x - line->through.x, dy = point.y - line->through.y;
      const double beside = -line->normal.y * dx + line->normal.x * dy;
      residual = line->normal.x * dx + line->normal.y * dy;
      on = std::abs(beside) <= kTangential && std::abs(residual) < kOnSurface;
    }
    on_surface += on;
    if (on) {
      const Point arm = frame.turned(beams[i]->end), &normal = line->normal;
      const double weight = precision * (fresh ? line->density : line->weight);
      fit->origins[line->origin].add(weight, residual, {normal.x, normal.y, -normal.x * arm.y + normal.y * arm.x});
    }
    against += !on && contradicts(map, from, point);
  }
  drop_noise(&fit->origins);
  const int known = on_surface + against;
  fit->share = known == 0 ? 0.0 : static_cast<double>(on_surface) / known;
  fit->known = beams.empty() ? 0.0 : static_cast<double>(known) / static_cast<double>(beams.size());
}

}  // namespace

Fit refine(const Surroundings& around, const Pose& start, const Pose& expected, const Pose& deviation,
           double surface_deviation, const MatchOptions& options, std::vector<Association>& associations, bool fresh) {
  const auto& [map, beams, eye, long_ago] = around;
  const double precision = 1.0 / (surface_deviation * surface_deviation);
  Fit fit{start};
  double reach = options.reach;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Pose& pose = fit.pose;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    information.diagonal() << 1.0 / (deviation.x * deviation.x), 1.0 / (deviation.y * deviation.y),
        1.0 / (deviation.yaw * deviation.yaw);
    const Eigen::Vector3d off(pose.x - expected.x, pose.y - expected.y, normalized(pose.yaw - expected.yaw));
    Evidence lately, old;
    const Frame frame(pose);
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const Point arm = frame.turned(beams[i]->end), normal = frame.turned(beams[i]->normal);
      const Point point{pose.x + arm.x, pose.y + arm.y};
      const Line* found = line_of(map, point, normal, reach, long_ago, associations[i]);
      if (found == nullptr) continue;
      const Line& line = *found;
      const double nx = line.normal.x, ny = line.normal.y;
      const double dx = point.x - line.through.x, dy = point.y - line.through.y;
      const double residual = nx * dx + ny * dy, beside = -ny * dx + nx * dy;
      if (std::abs(beside) > kTangential) continue;
      const double scaled = residual / (2.5 * options.surface_deviation);
      const double weight = precision * (fresh ? line.density : line.weight) / (1.0 + scaled * scaled);
      (line.origin <= long_ago ? old : lately).add(weight, residual, {nx, ny, -nx * arm.y + ny * arm.x});
    }
    // A far wall of long ago that comes into sight would turn the robot, and what it draws next with it.
    const Evidence sum = old.hits < lately.hits ? lately : lately + old;
    const Eigen::Matrix3d part = telling_part(sum.information);
    const Eigen::Matrix3d seen = part * sum.information * part;
    const Eigen::Vector3d step = (information + seen).ldlt().solve(-information * off - part * sum.pull);
    fit.pose = moved(pose, step);
    reach = std::max(0.5 * reach, kReachAtLast);
    if (iteration > 1 && step.head<2>().norm() < 2e-4 && std::abs(step.z()) < 1e-4) break;
  }
  judge(around, reach, precision, fresh, associations, &fit);
  return fit;
}

Fit judge_at(const Surroundings& around, const Pose& pose) {
  std::vector<Association> associations(around.beams.size());
  Fit fit{pose};
  judge(around, kReachAtLast, 1.0, false, associations, &fit);
  return fit;
}

}  // namespace mr_robot::slam
