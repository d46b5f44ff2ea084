#include "manoeuvre.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>
#include <unordered_map>
#include <unordered_set>

#include "body.hpp"

namespace mr_robot::navigation {
namespace {

constexpr int kHeadings = 32;               // of a whole turn
constexpr double kStep = 0.1;               // m of one motion
constexpr double kCell = 0.5 * kStep;       // m, so that each motion leaves its cell
constexpr double kTight = 2.0 * kTouching;  // m to obstacles, less than which costs
constexpr double kTightCost = 2.0;          // times the time, with none left or to turn where there is no room for it
constexpr double kUnknownCost = 10.0;       // times the time, to back over what the map does not show
constexpr double kNodesPerCell = 20.0;      // of the square that is as long as the search reaches
constexpr double kMostNodes = 20000.0;
constexpr double kCurvature = 2.0;  // rad/m

struct Node {
  Pose pose;
  double seconds, price;  // s until there, and with what the way is worth
  double way;             // m until there
  double direction;
  std::int32_t parent;
};

struct Open {
  double total;
  std::int32_t node;
  bool operator<(const Open& other) const { return total > other.total; }
};

Pose along(const Pose& pose, double way, double turn) {
  const double middle = pose.yaw + 0.5 * turn;
  return {pose.x + way * std::cos(middle), pose.y + way * std::sin(middle), pose.yaw + turn};
}

class Search {
 public:
  Search(const Field& field, const Map& map, const Pose& start, const std::vector<Obstacle>& obstacles,
         const Footprint& footprint, const Agility& agility, double known, double slack)
      : field_(field),
        map_(map),
        start_(start),
        obstacles_(obstacles),
        footprint_(footprint),
        agility_(agility),
        slack_(slack),
        reach_(std::max(kStep, known - footprint.radius - kStep)),
        rear_(footprint.rear(map.resolution)),
        body_(start, reach_ + kCell, kCell, obstacles, footprint) {
    at_start_ = body_.clearance(start);
    least_ = least_clearance(at_start_, slack);
    starts_roomy_ = body_.roomy(start);
    start_cost_ = cost_at(field, start.x, start.y);
  }

  std::vector<Waypoint> run() {
    nodes_.push_back({start_, 0.0, 0.0, 0.0, 0.0, -1});
    open_.push({left(start_), 0});
    const double most = std::min(kMostNodes, kNodesPerCell * reach_ * reach_ / (kCell * kCell));
    while (!open_.empty() && static_cast<double>(nodes_.size()) < most) {
      const Open next = open_.top();
      open_.pop();
      if (next.total >= best_total_) break;
      const Node node = nodes_[next.node];
      if (!visited_.insert(key(node.pose, node.direction)).second) continue;
      consider(next.node);
      expand(next.node);
    }
    const std::int32_t end = best_ >= 0 ? best_ : roomiest_;
    return end > 0 ? way_to(end) : std::vector<Waypoint>{};
  }

 private:
  // s by the field from there.
  double left(const Pose& pose) const {
    const double cost = cost_at(field_, pose.x, pose.y);
    if (std::isfinite(cost)) return cost * field_.resolution / agility_.limits.linear;
    return (std::isfinite(start_cost_) ? start_cost_ * field_.resolution + 2.0 * reach_ : 0.0) / agility_.limits.linear;
  }

  static std::uint64_t place_of(const Pose& pose) {
    const auto x = static_cast<std::int64_t>(std::floor(pose.x / kCell)) & 0xFFFFF;
    const auto y = static_cast<std::int64_t>(std::floor(pose.y / kCell)) & 0xFFFFF;
    return static_cast<std::uint64_t>((x << 20) | y);
  }

  static std::uint64_t key(const Pose& pose, double direction) {
    const auto heading = static_cast<std::int64_t>(std::lround(pose.yaw * kHeadings / (2.0 * M_PI))) & (kHeadings - 1);
    const std::int64_t way = direction < 0.0 ? 0 : 1;
    return (place_of(pose) << 8) | static_cast<std::uint64_t>((heading << 1) | way);
  }

  // Whether the way may end there, and if it is the best end.
  void consider(std::int32_t index) {
    const Node& node = nodes_[index];
    const bool roomy = body_.roomy(node.pose);
    const double off = std::hypot(node.pose.x - start_.x, node.pose.y - start_.y);
    if (roomy && !starts_roomy_ && roomiest_ < 0) roomiest_ = index;
    const bool ends = roomy ? !starts_roomy_ || node.way >= 2.0 * kStep : off >= reach_ - kStep || at_goal(node.pose);
    if (!ends || (roomy && !leads_on(node.pose)) || !std::isfinite(cost_at(field_, node.pose.x, node.pose.y))) return;
    double total = node.price + left(node.pose);
    if (const auto direction = downhill(field_, node.pose.x, node.pose.y)) {
      const double error = std::abs(mr_grid::normalized(*direction - node.pose.yaw));
      total += (roomy ? 1.0 : kTightCost) * error / agility_.limits.angular;
    }
    if (total >= best_total_) return;
    best_total_ = total;
    best_ = index;
  }

  // Whether the body fits all along the field from there on, as far as things are known, if it heads where it drives.
  // Else it would only come back to where it cannot get on.
  bool leads_on(const Pose& from) {
    const auto [known, first] = onward_.try_emplace(place_of(from), true);
    if (!first) return known->second;
    Pose pose = from;
    const int most = static_cast<int>(4.0 * reach_ / kStep);  // steps; a field may have a hollow between its cells
    for (int step = 0; step < most && distance({pose.x, pose.y}, {start_.x, start_.y}) < reach_; ++step) {
      if (at_goal(pose)) break;
      const auto direction = downhill(field_, pose.x, pose.y);
      if (!direction) break;
      pose = along({pose.x, pose.y, *direction}, kStep, 0.0);
      if (body_.clearance(pose) < least_) return known->second = false;
    }
    return true;
  }

  bool at_goal(const Pose& pose) const { return std::hypot(pose.x - field_.goal.x, pose.y - field_.goal.y) < kStep; }

  void expand(std::int32_t index) {
    for (const double direction : {1.0, -1.0}) {
      for (const double side : {0.0, 1.0, -1.0}) move(index, direction, side * kCurvature * kStep);
    }
    for (const double side : {1.0, -1.0}) move(index, 0.0, side * 2.0 * M_PI / kHeadings);
    // Along what the robot stands too close to: its corners come nearer before its middle gets away.
    if (index == 0 && at_start_ < kTight) {
      for (double curvature = kCurvature / 4.0; curvature > kCurvature / 100.0; curvature /= 2.0) {
        for (const double direction : {1.0, -1.0}) {
          for (const double side : {1.0, -1.0}) long_arc(direction, side * curvature);
        }
      }
    }
  }

  void long_arc(double direction, double curvature) {
    std::int32_t last = 0;
    for (double way = 0.0; way < reach_ && last >= 0; way += kStep) last = move(last, direction, curvature * kStep);
  }

  // Adds the node that a motion leads to; its number, or -1 if something is in the way or a better way leads there.
  std::int32_t move(std::int32_t from, double direction, double turn) {
    const Node& node = nodes_[from];
    const double way = direction * kStep;
    const Pose end = along(node.pose, way, turn);
    if (std::hypot(end.x - start_.x, end.y - start_.y) > reach_ + kStep) return -1;
    if (visited_.count(key(end, direction)) > 0) return -1;
    const double room = body_.clearance(end);
    if (room < least_ || body_.clearance(node.pose, along(node.pose, 0.5 * way, 0.5 * turn), end) < least_) return -1;
    double seconds = std::abs(way) / agility_.linear;
    if (direction == 0.0) seconds = std::abs(turn) / agility_.angular;
    if (from == 0 && !begins({way / seconds, turn / seconds})) return -1;
    if (node.parent >= 0 && direction != node.direction)
      seconds += 2.0 * agility_.linear / agility_.limits.linear_acceleration;
    double weight = 1.0 + kTightCost * std::clamp((kTight - room) / kTight, 0.0, 1.0);
    if (direction < 0.0 && backs_into_unknown(end)) weight += kUnknownCost;
    const Node next{end, node.seconds + seconds, node.price + seconds * weight, node.way + std::abs(way), direction,
                    from};
    nodes_.push_back(next);
    const auto number = static_cast<std::int32_t>(nodes_.size() - 1);
    open_.push({next.price + left(end), number});
    return number;
  }

  // Whether some of its edge, behind its middle, lies in what is unknown.
  bool backs_into_unknown(const Pose& pose) const {
    const mr_grid::Frame body(pose);
    return std::any_of(rear_.begin(), rear_.end(), [&](const Point& point) { return !is_known(map_, body * point); });
  }

  // Whether the robot, which stands, may set off like that.
  bool begins(const Velocity& target) const {
    Horizon horizon{kRamp};
    horizon.slack = slack_;
    return is_clear(start_, {0.0, 0.0}, target, obstacles_, agility_.limits, footprint_, horizon);
  }

  std::vector<Waypoint> way_to(std::int32_t end) const {
    std::vector<Waypoint> way;
    for (std::int32_t i = end; i >= 0; i = nodes_[i].parent) {
      const Node& node = nodes_[i];
      way.push_back({node.pose.x, node.pose.y, node.pose.yaw, node.direction, node.seconds});
    }
    std::reverse(way.begin(), way.end());
    return way;
  }

  const Field& field_;
  const Map& map_;
  Pose start_;
  const std::vector<Obstacle>& obstacles_;
  Footprint footprint_;
  Agility agility_;
  double slack_;
  double reach_;  // m around the start, with a step more the body stays within what is known
  std::vector<Point> rear_;
  Body body_;
  double at_start_ = 0.0, least_ = 0.0, start_cost_ = 0.0;
  bool starts_roomy_ = false;
  std::vector<Node> nodes_;
  std::priority_queue<Open> open_;
  std::unordered_set<std::uint64_t> visited_;
  std::unordered_map<std::uint64_t, bool> onward_;  // by place, whether it leads on
  std::int32_t best_ = -1, roomiest_ = -1;
  double best_total_ = std::numeric_limits<double>::infinity();
};

}  // namespace

std::vector<Waypoint> manoeuvre(const Field& field, const Map& map, const Pose& start,
                                const std::vector<Obstacle>& obstacles, const Footprint& footprint,
                                const Agility& agility, double known, double slack) {
  return Search(field, map, start, obstacles, footprint, agility, known, slack).run();
}

bool has_room_to_turn(const Pose& pose, const std::vector<Obstacle>& obstacles, const Footprint& footprint) {
  const double reach = footprint.radius + kTouching;
  return std::none_of(obstacles.begin(), obstacles.end(), [&](const Obstacle& obstacle) {
    const double dx = obstacle.x - pose.x, dy = obstacle.y - pose.y, near = reach + obstacle.margin;
    return dx * dx + dy * dy < near * near;
  });
}

}  // namespace mr_robot::navigation
