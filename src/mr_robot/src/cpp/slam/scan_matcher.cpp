#include "scan_matcher.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "surface_lines.hpp"

namespace mr_robot::slam {
namespace {

constexpr int kIterations = 12;
constexpr double kOnSurface = 0.05;    // m
constexpr double kReachAtLast = 0.12;  // m, how far from a surface a hit may be when the pose is nearly found
constexpr double kSure = 0.8;          // share on surfaces from which wheels are said to slip
constexpr double kMostKnown = 0.5;     // of the hits that must be known for that
constexpr double kThrough = 0.1;       // of the beams see through the map where the robot cannot be,
constexpr double kDrawnOff = 0.25;     // m by which walls of the map may be wrong there
constexpr double kSlip = 0.6;          // m and rad at most, by which wheels slip before that is seen
constexpr std::size_t kFewBeams = 10;
// What hits say of the position where they say least of it, 1: as much as where they say most. Below the first it is
// noise; from the second on all of it counts.
constexpr double kNoise = 0.005, kTelling = 0.02;
constexpr double kTangential = 0.08;        // m, a surface reaches this far beside its mean
constexpr double kAgreement = 16.0;         // squared deviations within which scan and odometry agree
constexpr std::size_t kMostSearched = 120;  // hits
constexpr std::size_t kLeastBeams = 30;     // to look for old surfaces with
constexpr double kLeastOnOld = 0.5;         // of all hits must lie on old surfaces, or
constexpr double kLeastElsewhere = 0.3;     // where the robot seems not to be, if
constexpr double kOfKnown = 0.95;           // of those in known parts do
constexpr double kMoreOnOld = 0.1;          // elsewhere: so many more than where the robot seems to be
constexpr double kBorder = 2.0;             // cells
constexpr Pose kTight{0.05, 0.05, 0.01};
constexpr Pose kRough{0.3, 0.3, 0.1};     // m and rad, of a place that was found on a coarse grid
constexpr double kPlaceDeviation = 0.03;  // m, to which hits must tell a place
constexpr double kTrust = 0.5;            // of odometry's deviation where scan and odometry agree

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

// What is steady while a scan is matched.
struct Surroundings {
  const GridMap& map;
  const std::vector<const Beam*>& beams;
  Point eye;
  int long_ago;  // see match_scan
};

struct Fit {
  Pose pose;
  double share = 0.0;  // of the hits in known parts, those on a surface
  double known = 0.0;  // share of the hits that lie in known parts
  std::map<int, Evidence> origins{};
};

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

// Gauss-Newton on point-to-line distances with Cauchy weights and the odometry prior. `fresh`: surfaces that were seen
// once count as well.
Fit refine(const Surroundings& around, const Pose& start, const Pose& expected, const Pose& deviation,
           double surface_deviation, const MatchOptions& options, std::vector<Association>& associations,
           bool fresh = false) {
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

// The cells of a map that have a surface, one byte each.
class Raster {
 public:
  Raster(const GridMap& map, const Cell& low, const Cell& high)
      : low_(low), width_(high.x - low.x + 1), bytes_(static_cast<std::size_t>(width_) * (high.y - low.y + 1)) {
    map.visit_marked(low, high, [this](const Cell& cell) { bytes_[index_of(cell)] = 1; });
  }
  // Of this cell and those to the right of it.
  const uint8_t* from(const Cell& cell) const { return &bytes_[index_of(cell)]; }

 private:
  std::size_t index_of(const Cell& cell) const {
    return static_cast<std::size_t>(cell.y - low_.y) * width_ + cell.x - low_.x;
  }

  Cell low_;
  int width_;
  std::vector<uint8_t> bytes_;
};

// Exhaustive search over a window (correlative matching, Olson 2009) on every fourth hit at most. For each turn all
// shifts are counted together, hit by hit: that is a sum of rows of bytes.
Pose search(const GridMap& map, const std::vector<const Beam*>& beams, const Pose& center, const Pose& window) {
  const double step = map.resolution(), turn_step = 0.025;
  const int steps = static_cast<int>(std::ceil(window.x / step)), side = 2 * steps + 1;
  const int turns = static_cast<int>(std::ceil(window.yaw / turn_step));
  const std::size_t stride = std::max<std::size_t>(4, beams.size() / kMostSearched);
  double far = 0.0;  // m from the robot, of the hits
  for (std::size_t i = 0; i < beams.size(); i += stride) {
    far = std::max(far, length_of(beams[i]->end.x, beams[i]->end.y));
  }
  const Cell low = map.cell_of({center.x - far, center.y - far}), high = map.cell_of({center.x + far, center.y + far});
  const int margin = steps + 1;
  const Raster raster(map, {low.x - margin, low.y - margin}, {high.x + margin, high.y + margin});
  Pose best = center;
  double best_score = -1.0;
  std::vector<uint8_t> on(static_cast<std::size_t>(side) * side);  // less than twice `kMostSearched` each
  for (int turn = -turns; turn <= turns; ++turn) {
    const Pose turned{center.x, center.y, normalized(center.yaw + turn * turn_step)};
    const Frame frame(turned);
    std::fill(on.begin(), on.end(), 0);
    for (std::size_t i = 0; i < beams.size(); i += stride) {
      const Cell cell = map.cell_of(frame * beams[i]->end);
      for (int dy = -steps; dy <= steps; ++dy) {
        const uint8_t* row = raster.from({cell.x - steps, cell.y + dy});
        uint8_t* sums = &on[static_cast<std::size_t>(dy + steps) * side];
        for (int dx = 0; dx < side; ++dx) sums[dx] = static_cast<uint8_t>(sums[dx] + row[dx]);
      }
    }
    for (int dy = -steps; dy <= steps; ++dy) {
      for (int dx = -steps; dx <= steps; ++dx) {
        // Ties go to the pose nearest to the expectation.
        const double off = 1e-3 * (dx * dx + dy * dy) + 1e-2 * turn * turn;
        const double score = on[static_cast<std::size_t>(dy + steps) * side + dx + steps] - off;
        if (score <= best_score) continue;
        best_score = score;
        best = {center.x + dx * step, center.y + dy * step, turned.yaw};
      }
    }
  }
  return best;
}

bool agree(const Pose& a, const Pose& b, const Pose& deviation) {
  const double x = (a.x - b.x) / deviation.x, y = (a.y - b.y) / deviation.y;
  const double yaw = normalized(a.yaw - b.yaw) / deviation.yaw;
  return x * x + y * y + yaw * yaw < kAgreement;
}

// Of all hits, those on surfaces.
double share_on(const Fit& fit) { return fit.share * fit.known; }

// Information about the position, map frame.
Eigen::Matrix2d said_of_position(const Fit& fit) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  for (const auto& [origin, evidence] : fit.origins) information += evidence.information.topLeftCorner<2, 2>();
  return information;
}

// Whether hits tell the fit from the poses on the way to it: along a corridor they lie on its walls anywhere.
bool tells_from(const Fit& fit, const Pose& pose) {
  const Eigen::Vector2d way(fit.pose.x - pose.x, fit.pose.y - pose.y);
  const Eigen::Matrix2d information = said_of_position(fit);
  return way.dot(information * way) > kTelling * information.trace() * way.squaredNorm();
}

// Share of the scan, beside a prior of that standard deviation, in what is known of the position along the heading.
double share_along(const Fit& fit, double deviation) {
  const Eigen::Vector2d heading(std::cos(fit.pose.yaw), std::sin(fit.pose.yaw));
  const double information = heading.dot(said_of_position(fit) * heading);
  return information / (information + 1.0 / (deviation * deviation));
}

// Of all beams, those that pass a surface of the map.
double share_through(const GridMap& map, const Scan& scan, const Pose& pose) {
  const Frame frame(pose);
  const Point eye = frame * scan.eye;
  const auto passes = [&](const Beam& beam) { return map.blocked(eye, frame * beam.end); };
  const auto count = std::count_if(scan.beams.begin(), scan.beams.end(), passes);
  return scan.beams.empty() ? 0.0 : static_cast<double>(count) / static_cast<double>(scan.beams.size());
}

// What a scan says that shows nothing known: where it sees through walls the robot is not.
Match without_surfaces(const GridMap& map, const Scan& scan, const Pose& expected, const std::optional<Pose>& previous,
                       const Match& otherwise) {
  if (!previous || distance(*previous, expected) > kSlip || std::abs(normalized(expected.yaw - previous->yaw)) > kSlip)
    return otherwise;
  if (share_through(map, scan, expected) < kThrough) return otherwise;
  if (share_through(map, scan, *previous) >= 0.25 * kThrough) return otherwise;
  // Walls that are drawn a little off explain it, too.
  for (const auto& [x, y] : {std::pair(kDrawnOff, 0.0), {-kDrawnOff, 0.0}, {0.0, kDrawnOff}, {0.0, -kDrawnOff}}) {
    if (share_through(map, scan, expected * Pose{x, y, 0.0}) < 0.5 * kThrough) return otherwise;
  }
  return {expected, 0.0, Outcome::kContradicts, previous, true};
}

bool better(const Fit& fit, const Fit& than) { return fit.share > than.share + 0.05; }

}  // namespace

Match match_scan(const GridMap& map, const Scan& scan, const Pose& expected, const Pose& deviation,
                 const std::optional<Pose>& previous, bool sparse, int long_ago, const MatchOptions& options) {
  const std::vector<const Beam*> beams = spaced_hits(scan);
  if (beams.size() < kFewBeams) {
    return without_surfaces(map, scan, expected, previous, {expected, 0.0, Outcome::kNothingSeen});
  }
  const Surroundings around{map, beams, scan.eye, long_ago};
  std::vector<Association> associations(beams.size());
  const auto fit = [&](const Pose& start) {
    return refine(around, start, start, deviation, options.surface_deviation, options, associations, sparse);
  };
  Fit best = fit(expected);
  if (best.known < options.known_share) {
    return without_surfaces(map, scan, expected, previous, {expected, best.share});
  }
  if (best.share < options.good_share) {
    Match match{expected, best.share, Outcome::kContradicts};
    Fit other = fit(previous.value_or(expected));
    match.stays = better(other, best) && other.share >= kSure && other.known >= kMostKnown;
    if (!match.stays && best.share < options.poor_share)
      other = fit(search(map, beams, expected, {options.window, options.window, options.angular_window}));
    const bool found = other.known >= options.known_share && better(other, best);
    const bool good = found && other.share >= options.good_share;
    if (sparse && good && !match.stays && agree(other.pose, expected, deviation)) {
      best = other;
    } else {
      if (good) match.elsewhere = other.pose;
      if (found || best.share < options.poor_share) return match;
    }
  }
  // Neighbouring hits err together (walls on cell borders, corners), so where the wheels do not slip odometry is
  // worth more beside the scan than independent hits would leave it; this keeps headings from creeping. And where walls
  // fix no position along them, a robot that drives ahead must not carry this one with it: odometry is overruled only
  // where it explains the scan worse.
  const bool agreed = agree(best.pose, expected, deviation);
  const Pose trusted{kTrust * deviation.x, kTrust * deviation.y, deviation.yaw};
  const Fit joint = refine(around, agreed ? best.pose : expected, expected, trusted, options.joint_deviation, options,
                           associations, sparse);
  if (!agreed && better(best, joint)) return {expected, joint.share, Outcome::kContradicts, best.pose};
  if (joint.share < options.poor_share) return {expected, joint.share, Outcome::kContradicts};
  Match match{joint.pose, joint.share, Outcome::kMatched};
  match.known = joint.known;
  match.along = share_along(joint, trusted.x);
  match.origins = joint.origins;
  return match;
}

std::optional<Match> match_old(const GridMap& old, const Scan& scan, const Pose& pose, const Pose& window,
                               const MatchOptions& options) {
  const std::vector<const Beam*> beams = spaced_hits(scan);
  if (beams.size() < kLeastBeams) return std::nullopt;
  const Surroundings around{old, beams, scan.eye, kNothingOld};
  const auto fit = [&](const Pose& start, const Pose& deviation) {
    std::vector<Association> associations(beams.size());
    return refine(around, start, start, deviation, options.surface_deviation, options, associations);
  };
  const Fit now = fit(pose, kTight);
  const Fit best = fit(search(old, beams, pose, window), window);
  const bool elsewhere = share_on(best) > share_on(now) + kMoreOnOld && tells_from(best, pose);
  // At the border of the window the scan may fit better beyond.
  const double border = kBorder * old.resolution();
  const auto at_border = [&](double off, double most) { return std::abs(off) > most - border; };
  if (elsewhere && (at_border(best.pose.x - pose.x, window.x) || at_border(best.pose.y - pose.y, window.y)))
    return std::nullopt;
  const Fit& found = elsewhere ? best : now;
  const double least = elsewhere && found.share >= kOfKnown ? kLeastElsewhere : kLeastOnOld;
  if (share_on(found) < least) return std::nullopt;
  Match match{found.pose, found.share, Outcome::kMatched};
  if (elsewhere) match.elsewhere = found.pose;
  match.known = found.known;
  match.origins = found.origins;
  return match;
}

Match match_place(const GridMap& map, const std::vector<Scan>& scans, const Pose& pose, const MatchOptions& options) {
  std::vector<const Beam*> all;
  for (const Scan& scan : scans) {
    for (const Beam& beam : scan.beams) all.push_back(&beam);
  }
  std::vector<Association> associations(all.size());
  const Surroundings together{map, all, scans.back().eye, kNothingOld};
  const Fit fit = refine(together, pose, pose, kRough, options.surface_deviation, options, associations);
  Match match{fit.pose, 0.0, Outcome::kMatched};
  match.origins = fit.origins;
  double known = 0.0, on = 0.0;  // hits
  for (const Scan& scan : scans) {
    std::vector<const Beam*> beams;
    for (const Beam& beam : scan.beams) beams.push_back(&beam);
    std::vector<Association> each(beams.size());
    Fit part{fit.pose};
    judge({map, beams, scan.eye, kNothingOld}, kReachAtLast, 1.0, false, each, &part);
    known += part.known * static_cast<double>(beams.size());
    on += part.known * part.share * static_cast<double>(beams.size());
  }
  match.share = known > 0.0 ? on / known : 0.0;
  match.known = all.empty() ? 0.0 : known / static_cast<double>(all.size());
  return match;
}

bool tells_place(const Match& match) {
  Fit fit{match.pose};
  fit.origins = match.origins;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(said_of_position(fit), Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0) * kPlaceDeviation * kPlaceDeviation > 1.0;
}

}  // namespace mr_robot::slam
