#include "scan_matcher.hpp"

#include <Eigen/Dense>
#include <algorithm>

#include "correlative_search.hpp"
#include "scan_fit.hpp"

namespace mr_robot::slam {
namespace {

constexpr double kSure = 0.8;       // share on surfaces from which wheels are said to slip
constexpr double kMostKnown = 0.5;  // of the hits that must be known for that
constexpr double kThrough = 0.1;    // of the beams see through the map where the robot cannot be,
constexpr double kDrawnOff = 0.25;  // m by which walls of the map may be wrong there
constexpr double kSlip = 0.6;       // m and rad at most, by which wheels slip before that is seen
constexpr std::size_t kFewBeams = 10;
constexpr double kAgreement = 16.0;      // squared deviations within which scan and odometry agree
constexpr std::size_t kLeastBeams = 30;  // to look for old surfaces with
constexpr double kLeastOnOld = 0.5;      // of all hits must lie on old surfaces, or
constexpr double kLeastElsewhere = 0.3;  // where the robot seems not to be, if
constexpr double kOfKnown = 0.95;        // of those in known parts do
constexpr double kMoreOnOld = 0.1;       // elsewhere: so many more than where the robot seems to be
constexpr double kBorder = 2.0;          // cells
constexpr Pose kTight{0.05, 0.05, 0.01};
constexpr Pose kRough{0.3, 0.3, 0.1};     // m and rad, of a place that was found on a coarse grid
constexpr double kPlaceDeviation = 0.03;  // m, to which hits must tell a place
constexpr double kTrust = 0.5;            // of odometry's deviation where scan and odometry agree

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
      other = fit(correlative_search(map, beams, expected, {options.window, options.window, options.angular_window}));
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
  const Fit best = fit(correlative_search(old, beams, pose, window), window);
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
    const Fit part = judge_at({map, beams, scan.eye, kNothingOld}, fit.pose);
    known += part.known * static_cast<double>(beams.size());
    on += part.known * part.share * static_cast<double>(beams.size());
  }
  match.share = known > 0.0 ? on / known : 0.0;
  match.known = all.empty() ? 0.0 : known / static_cast<double>(all.size());
  return match;
}

bool tells_place(const Match& match, int last) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  for (const auto& [origin, evidence] : match.origins) {
    if (origin <= last) information += evidence.information.topLeftCorner<2, 2>();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(information, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0) * kPlaceDeviation * kPlaceDeviation > 1.0;
}

}  // namespace mr_robot::slam
