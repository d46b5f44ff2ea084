#include "rollout.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <queue>
#include <tuple>
#include <utility>

namespace mr_robot::navigation {
namespace {

double approach(double value, double target, double change) {
  return value + std::clamp(target - value, -change, change);
}

// Where the robot heads in one step, and at its end.
struct Heading {
  double cosine, sine, yaw;
};

// Of each step of a motion; the same for all its speeds.
std::vector<Heading> turn(double yaw, double angular, double target, const Limits& limits, const Horizon& horizon) {
  std::vector<Heading> headings(std::lround(horizon.duration / horizon.step));
  for (Heading& heading : headings) {
    angular = approach(angular, target, limits.angular_acceleration * horizon.step);
    const double middle = yaw + 0.5 * angular * horizon.step;
    yaw += angular * horizon.step;
    heading = {std::cos(middle), std::sin(middle), yaw};
  }
  return headings;
}

// Where a motion ends: after its last step, or within the goal's radius if it comes there.
struct End {
  Pose pose;
  double arrived = -1.0;  // s, when it came to the goal
};

// Gives `visit` the pose after each step.
template <typename Visit>
End drive(const Field* field, Pose pose, double linear, double target, const std::vector<Heading>& headings,
          const Limits& limits, const Horizon& horizon, Visit visit) {
  const double near = horizon.goal_radius * horizon.goal_radius;
  int steps = 0;
  for (const Heading& heading : headings) {
    linear = approach(linear, target, limits.linear_acceleration * horizon.step);
    pose.x += linear * horizon.step * heading.cosine;
    pose.y += linear * horizon.step * heading.sine;
    pose.yaw = heading.yaw;
    visit(pose);
    ++steps;
    if (field == nullptr) continue;
    const double dx = pose.x - field->goal.x, dy = pose.y - field->goal.y;
    if (dx * dx + dy * dy < near) return {pose, steps * horizon.step};
  }
  return {pose};
}

// How far a motion touches nothing, and the least clearance with margins on that way.
struct ClearWay {
  std::size_t count = 0;  // of its poses
  double nearest = kUnreached;
};

ClearWay clear_poses(const std::vector<Pose>& poses, const Velocity& target, const std::vector<Obstacle>& obstacles,
                     const Clearance& at_start, const Footprint& footprint, double slack) {
  // From inside a margin only ways that lead no deeper are open.
  const double least = std::min(0.0, at_start.with_margins - kSlack);
  const double least_bare = least_clearance(at_start.bare, slack);
  ClearWay way;
  double before = at_start.bare;
  for (const Pose& pose : poses) {
    const Clearance now = clearance(pose, std::abs(target.linear), obstacles, footprint);
    // Margins grow with speed; a motion that leads away may have it all the same, or no way out would be open.
    const bool leads_away = now.bare > before;
    if ((now.with_margins < least && !leads_away) || now.bare < least_bare) break;
    ++way.count;
    way.nearest = std::min(way.nearest, now.with_margins);
    before = now.bare;
  }
  return way;
}

// The least clearance with margins on the way; nothing if the motion touches something.
std::optional<double> way_clearance(const std::vector<Pose>& poses, const Velocity& target,
                                    const std::vector<Obstacle>& obstacles, const Clearance& at_start,
                                    const Footprint& footprint, double slack) {
  const ClearWay way = clear_poses(poses, target, obstacles, at_start, footprint, slack);
  if (way.count < poses.size()) return std::nullopt;
  return way.nearest;
}

// Without what the heading costs.
double time_left(const Field& field, const End& end, const Limits& limits, const Horizon& horizon) {
  if (end.arrived >= 0.0) return end.arrived;
  const double cost = cost_at(field, end.pose.x, end.pose.y);
  return std::isfinite(cost) ? horizon.duration + cost * field.resolution / limits.linear : kUnreached;
}

double time_to_turn(const Field& field, const End& end, const Limits& limits) {
  const auto direction = end.arrived >= 0.0 ? std::nullopt : downhill(field, end.pose.x, end.pose.y);
  if (!direction) return 0.0;
  return kHeadingWeight * std::abs(mr_grid::normalized(*direction - end.pose.yaw)) / limits.angular;
}

// A motion that can be chosen. Until it is complete its time is the least that it can be.
struct Candidate {
  double time;         // with what another rate of turn costs
  std::size_t number;  // of motions that take equally long, the first is the better one
  double way_time;
  double change;  // of the rate of turn, as time
  Velocity target;
  const std::vector<Heading>* headings;
  End end;
  bool complete = false;

  void add(double turning) {
    time = way_time + turning + change;
    complete = true;
  }

  bool operator>(const Candidate& other) const { return std::tie(time, number) > std::tie(other.time, other.number); }
};

std::vector<double> speeds(const Limits& limits) {
  std::vector<double> values{0.0};
  for (const double share : {0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0}) values.push_back(share * limits.linear);
  return values;
}

}  // namespace

double cost_at(const Field& field, double x, double y) {
  const double column = (x - field.origin.x) / field.resolution - 0.5;
  const double row = (y - field.origin.y) / field.resolution - 0.5;
  const int c = static_cast<int>(std::floor(column)), r = static_cast<int>(std::floor(row));
  double sum = 0.0, weights = 0.0;
  for (int dr = 0; dr < 2; ++dr) {
    for (int dc = 0; dc < 2; ++dc) {
      const int rr = r + dr, cc = c + dc;
      if (!field.contains(rr, cc)) continue;
      const float cost = field.at(rr, cc);
      if (!std::isfinite(cost)) continue;
      const double weight = (1.0 - std::abs(column - cc)) * (1.0 - std::abs(row - rr));
      sum += weight * cost;
      weights += weight;
    }
  }
  return weights > 1e-6 ? sum / weights : kUnreached;
}

std::optional<double> downhill(const Field& field, double x, double y) {
  const double h = 2.0 * field.resolution;
  const double here = cost_at(field, x, y);
  const auto slope = [&](double dx, double dy) {
    const double ahead = cost_at(field, x + dx, y + dy), behind = cost_at(field, x - dx, y - dy);
    if (std::isfinite(ahead) && std::isfinite(behind)) return 0.5 * (ahead - behind);
    if (std::isfinite(ahead)) return std::min(0.0, ahead - here);
    if (std::isfinite(behind)) return std::max(0.0, here - behind);
    return 0.0;
  };
  const double gx = slope(h, 0.0), gy = slope(0.0, h);
  if (gx == 0.0 && gy == 0.0) return std::nullopt;
  return std::atan2(-gy, -gx);
}

Clearance clearance(const Pose& pose, double speed, const std::vector<Obstacle>& obstacles,
                    const Footprint& footprint) {
  const mr_grid::Frame body(pose);
  Clearance least{kUnreached, kUnreached};
  for (const Obstacle& obstacle : obstacles) {
    const Point place = body.seen({obstacle.x, obstacle.y});
    const double margin = obstacle.margin + obstacle.reaction_time * speed;
    const double distance = footprint.distance(place, std::max(least.bare, least.with_margins + margin));
    least.bare = std::min(least.bare, distance);
    least.with_margins = std::min(least.with_margins, distance - margin);
  }
  return least;
}

Choice choose(const Field& field, const Pose& pose, const Velocity& velocity, const std::vector<Obstacle>& obstacles,
              const Limits& limits, const Footprint& footprint, const Horizon& horizon, double period) {
  constexpr int kTurns = 12;  // to each side
  std::vector<double> rates;
  std::vector<std::vector<Heading>> headings;
  for (int side = -kTurns; side <= kTurns; ++side) {
    // Finer around straight ahead.
    const double share = static_cast<double>(side) / kTurns;
    rates.push_back(limits.angular * share * std::abs(share));
    headings.push_back(turn(pose.yaw, velocity.angular, rates.back(), limits, horizon));
  }
  std::vector<Candidate> candidates;
  for (const double linear : speeds(limits)) {
    for (std::size_t i = 0; i < rates.size(); ++i) {
      const Velocity target{linear, rates[i]};
      if (linear > 0.0 && std::abs(rates[i]) > limits.curvature * linear) continue;
      const End end = drive(&field, pose, velocity.linear, linear, headings[i], limits, horizon, [](const Pose&) {});
      const double time = time_left(field, end, limits, horizon);
      const double change = kSteadiness * std::abs(target.angular - velocity.angular);
      if (time + change >= kUnreached) continue;
      candidates.push_back({time + change, candidates.size(), time, change, target, &headings[i], end});
    }
  }
  // Whether a motion touches something takes longest to find out, and how it would head long: the best ones are asked
  // first.
  std::priority_queue open(std::greater<>{}, std::move(candidates));
  Choice best{{0.0, 0.0}, {0.0, 0.0}, kUnreached, 0.0, 0.0, false};
  const Clearance at_start = clearance(pose, 0.0, obstacles, footprint);
  std::vector<Pose> poses;
  while (!open.empty()) {
    Candidate candidate = open.top();
    open.pop();
    if (!candidate.complete) {
      candidate.add(time_to_turn(field, candidate.end, limits));
      open.push(candidate);
      continue;
    }
    poses.clear();
    drive(&field, pose, velocity.linear, candidate.target.linear, *candidate.headings, limits, horizon,
          [&](const Pose& reached) { poses.push_back(reached); });
    const auto nearest = way_clearance(poses, candidate.target, obstacles, at_start, footprint, horizon.slack);
    if (!nearest) continue;
    best.time = candidate.time;
    best.target = candidate.target;
    best.clearance = *nearest;
    best.found = true;
    break;
  }
  const End here{pose};
  best.gained = time_left(field, here, limits, horizon) + time_to_turn(field, here, limits) - best.time;
  best.velocity = {approach(velocity.linear, best.target.linear, limits.linear_acceleration * period),
                   approach(velocity.angular, best.target.angular, limits.angular_acceleration * period)};
  return best;
}

bool is_clear(const Pose& pose, const Velocity& velocity, const Velocity& target,
              const std::vector<Obstacle>& obstacles, const Limits& limits, const Footprint& footprint,
              const Horizon& horizon) {
  const Clearance at_start = clearance(pose, 0.0, obstacles, footprint);
  const auto headings = turn(pose.yaw, velocity.angular, target.angular, limits, horizon);
  std::vector<Pose> poses;
  drive(nullptr, pose, velocity.linear, target.linear, headings, limits, horizon,
        [&](const Pose& reached) { poses.push_back(reached); });
  return way_clearance(poses, target, obstacles, at_start, footprint, horizon.slack).has_value();
}

}  // namespace mr_robot::navigation
