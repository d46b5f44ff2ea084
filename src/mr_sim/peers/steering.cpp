#include "steering.hpp"

#include <ompl/base/spaces/ReedsSheppStateSpace.h>

#include <cmath>
#include <memory>

namespace navigation_peers {
namespace {

constexpr double kLeast = 1e-6;  // m, rad

double turned(double from, double to) { return std::remainder(to - from, 2.0 * M_PI); }

}  // namespace

std::vector<Arc> turn_drive_turn(const Pose& from, const Pose& to) {
  const double way = std::hypot(to.x - from.x, to.y - from.y);
  if (way < kLeast) return {{0.0, turned(from.yaw, to.yaw)}};
  const double ahead = std::atan2(to.y - from.y, to.x - from.x), back = ahead + M_PI;
  const auto turning = [&](double heading) {
    return std::abs(turned(from.yaw, heading)) + std::abs(turned(heading, to.yaw));
  };
  const bool drives_ahead = turning(ahead) <= turning(back);
  const double heading = drives_ahead ? ahead : back;
  return {{0.0, turned(from.yaw, heading)}, {drives_ahead ? way : -way, 0.0}, {0.0, turned(heading, to.yaw)}};
}

Steering reeds_shepp(double radius) {
  auto space = std::make_shared<ompl::base::ReedsSheppStateSpace>(radius);
  return [space, radius](const Pose& from, const Pose& to) {
    using Space = ompl::base::ReedsSheppStateSpace;
    Space::StateType* a = space->allocState()->as<Space::StateType>();
    Space::StateType* b = space->allocState()->as<Space::StateType>();
    a->setXY(from.x, from.y), a->setYaw(from.yaw);
    b->setXY(to.x, to.y), b->setYaw(to.yaw);
    const Space::ReedsSheppPath path = space->reedsShepp(a, b);
    space->freeState(a), space->freeState(b);
    std::vector<Arc> arcs;
    for (int i = 0; i < 5 && path.type_[i] != Space::RS_NOP; ++i) {
      const double length = path.length_[i];
      if (std::abs(length) < kLeast) continue;
      const double side = path.type_[i] == Space::RS_LEFT ? 1.0 : path.type_[i] == Space::RS_RIGHT ? -1.0 : 0.0;
      arcs.push_back({radius * length, side * length});
    }
    return arcs;
  };
}

Pose along(const Pose& pose, const Arc& arc) {
  const double half = 0.5 * arc.turn;
  const double chord = std::abs(half) < kLeast ? arc.way : arc.way * std::sin(half) / half;
  return {pose.x + chord * std::cos(pose.yaw + half), pose.y + chord * std::sin(pose.yaw + half), pose.yaw + arc.turn};
}

Arc part(const Arc& arc, double share) { return {share * arc.way, share * arc.turn}; }

}  // namespace navigation_peers
