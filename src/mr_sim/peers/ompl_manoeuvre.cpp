#include "ompl_manoeuvre.hpp"

#include <ompl/base/MotionValidator.h>
#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/PlannerTerminationCondition.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/util/RandomNumbers.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "body.hpp"
#include "steering.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace navigation_peers {
namespace {

using mr_robot::navigation::Agility;
using mr_robot::navigation::Body;
using mr_robot::navigation::Field;
using mr_robot::navigation::Footprint;
using mr_robot::navigation::kSlack;
using mr_robot::navigation::kTouching;
using mr_robot::navigation::Obstacle;
using mr_robot::navigation::Pose;
using mr_robot::navigation::Waypoint;

// As in manoeuvre.cpp.
constexpr double kReach = 0.9;      // m
constexpr double kStep = 0.1;       // m of one motion
constexpr double kTurnStep = 0.2;   // rad
constexpr double kLeastWay = 0.25;  // m of a way from where there is room already
constexpr double kReversal = 0.5;   // s
constexpr double kTight = 0.06;     // m
constexpr double kTightCost = 2.0;
constexpr double kTurnCost = 2.0;

constexpr double kNoGoal = 1e3;  // s that an end is worth from where no way to the goal is known
constexpr int kFewestDrawn = 400;
constexpr double kDrawing = 0.2;  // of the time, for ends
constexpr std::size_t kEnds = 20;
constexpr double kFavour = 3.0;

double processor_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Pose pose_of(const ob::State* state) {
  const auto* se2 = state->as<ob::SE2StateSpace::StateType>();
  return {se2->getX(), se2->getY(), se2->getYaw()};
}

void set_pose(ob::State* state, const Pose& pose) {
  auto* se2 = state->as<ob::SE2StateSpace::StateType>();
  se2->setXY(pose.x, pose.y);
  se2->setYaw(std::remainder(pose.yaw, 2.0 * M_PI));
}

double direction_of(const Arc& arc) { return arc.way > 0.0 ? 1.0 : arc.way < 0.0 ? -1.0 : 0.0; }

double seconds_of(const Arc& arc, const Agility& agility) {
  return arc.way != 0.0 ? std::abs(arc.way) / agility.linear : std::abs(arc.turn) / agility.angular;
}

int steps_of(const Arc& arc, double share) {
  const double steps = std::max(std::abs(arc.way) / (share * kStep), std::abs(arc.turn) / (share * kTurnStep));
  return std::max(1, static_cast<int>(std::ceil(steps)));
}

// Poses, as far apart as the time between them.
class SteeredSpace : public ob::SE2StateSpace {
 public:
  SteeredSpace(std::vector<Steering> steerings, const Agility& agility)
      : steerings_(std::move(steerings)), agility_(agility) {}

  // The next of the steerings, in turns.
  void next_steering() { present_ = (present_ + 1) % steerings_.size(); }

  std::vector<Arc> arcs(const ob::State* from, const ob::State* to) const {
    return steerings_[present_](pose_of(from), pose_of(to));
  }

  bool isMetricSpace() const override { return false; }

  double distance(const ob::State* from, const ob::State* to) const override {
    double seconds = 0.0;
    for (const Arc& arc : arcs(from, to)) seconds += seconds_of(arc, agility_);
    return seconds;
  }

  void interpolate(const ob::State* from, const ob::State* to, double share, ob::State* state) const override {
    const std::vector<Arc> way = arcs(from, to);
    double left = share * distance(from, to);
    Pose pose = pose_of(from);
    for (const Arc& arc : way) {
      const double seconds = seconds_of(arc, agility_);
      pose = along(pose, part(arc, seconds > left ? left / seconds : 1.0));
      if (seconds > left) break;
      left -= seconds;
    }
    set_pose(state, pose);
  }

 private:
  std::vector<Steering> steerings_;
  std::size_t present_ = 0;
  Agility agility_;
};

// What may be passed, and with what it is worth.
class Ground {
 public:
  Ground(const Field& field, const Pose& start, const std::vector<Obstacle>& obstacles, const Footprint& footprint,
         const Agility& agility)
      : field_(field),
        start_(start),
        agility_(agility),
        body_(start, kReach + 2.0 * kStep, 0.5 * kStep, obstacles, footprint) {
    least_ = std::min(kTouching, body_.clearance(start) - kSlack);
    starts_roomy_ = body_.roomy(start);
  }

  bool passable(const Pose& pose) {
    return std::hypot(pose.x - start_.x, pose.y - start_.y) <= kReach + kStep && body_.clearance(pose) >= least_;
  }

  bool passable(Pose pose, const std::vector<Arc>& arcs) {
    for (const Arc& arc : arcs) {
      const int steps = steps_of(arc, 0.5);
      for (int i = 0; i < steps; ++i) {
        pose = along(pose, part(arc, 1.0 / steps));
        if (!passable(pose)) return false;
      }
    }
    return true;
  }

  double price(Pose pose, const std::vector<Arc>& arcs) {
    double total = 0.0, direction = 0.0;
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      const int steps = steps_of(arcs[k], 1.0);
      const double seconds = seconds_of(arcs[k], agility_) / steps;
      if (k > 0 && direction_of(arcs[k]) != direction) total += kReversal;
      direction = direction_of(arcs[k]);
      for (int i = 0; i < steps; ++i) {
        pose = along(pose, part(arcs[k], 1.0 / steps));
        total += seconds * (1.0 + kTightCost * std::clamp((kTight - body_.clearance(pose)) / kTight, 0.0, 1.0));
      }
    }
    return total;
  }

  // s to the goal of the field from an end there; infinity where a manoeuvre cannot end.
  double left(const Pose& pose) {
    const double cost = mr_robot::navigation::cost_at(field_, pose.x, pose.y);
    const double off = std::hypot(pose.x - start_.x, pose.y - start_.y);
    const bool roomy = body_.roomy(pose);
    const bool at_goal = std::hypot(pose.x - field_.goal_x, pose.y - field_.goal_y) < kStep;
    const bool ends = roomy ? !starts_roomy_ || off >= kLeastWay : off >= kReach - kStep || at_goal;
    if (!ends || !std::isfinite(cost)) return std::numeric_limits<double>::infinity();
    double total = cost * field_.resolution / agility_.limits.linear;
    if (const auto direction = mr_robot::navigation::downhill(field_, pose.x, pose.y)) {
      const double error = std::abs(std::remainder(*direction - pose.yaw, 2.0 * M_PI));
      total += (roomy ? 1.0 : kTurnCost) * error / agility_.limits.angular;
    }
    return total;
  }

  bool gains_room(const Pose& pose) { return !starts_roomy_ && body_.roomy(pose); }

  const Field& field() const { return field_; }
  const Pose& start() const { return start_; }

 private:
  const Field& field_;
  Pose start_;
  Agility agility_;
  Body body_;
  double least_ = 0.0;
  bool starts_roomy_ = false;
};

class ClearMotions : public ob::MotionValidator {
 public:
  ClearMotions(const ob::SpaceInformationPtr& information, const SteeredSpace& space, Ground& ground)
      : ob::MotionValidator(information), space_(space), ground_(ground) {}

  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return ground_.passable(pose_of(from), space_.arcs(from, to));
  }

  bool checkMotion(const ob::State* from, const ob::State* to, std::pair<ob::State*, double>& last) const override {
    if (last.first != nullptr) si_->copyState(last.first, from);
    last.second = 0.0;
    return checkMotion(from, to);
  }

 private:
  const SteeredSpace& space_;
  Ground& ground_;
};

class Price : public ob::OptimizationObjective {
 public:
  Price(const ob::SpaceInformationPtr& information, const SteeredSpace& space, Ground& ground)
      : ob::OptimizationObjective(information), space_(space), ground_(ground) {}

  ob::Cost stateCost(const ob::State*) const override { return identityCost(); }

  ob::Cost motionCost(const ob::State* from, const ob::State* to) const override {
    return ob::Cost(ground_.price(pose_of(from), space_.arcs(from, to)));
  }

 private:
  const SteeredSpace& space_;
  Ground& ground_;
};

// Ends by the time to them where nothing is in the way and from them on; where there is none, poses with room.
std::vector<Pose> draw_ends(Ground& ground, const Steering& steering, const Agility& agility, double until) {
  ompl::RNG random;
  std::vector<std::pair<double, Pose>> ends, roomy;
  for (int i = 0; i < kFewestDrawn || processor_time() < until; ++i) {
    const double off = i % 2 == 0 ? random.uniformReal(kReach - kStep, kReach) : kReach * std::sqrt(random.uniform01());
    const double bearing = random.uniformReal(-M_PI, M_PI);
    Pose pose{ground.start().x + off * std::cos(bearing), ground.start().y + off * std::sin(bearing),
              random.uniformReal(-M_PI, M_PI)};
    const auto downhill = mr_robot::navigation::downhill(ground.field(), pose.x, pose.y);
    if (downhill && i % 4 < 2) pose.yaw = *downhill + (i % 8 < 4 ? 0.0 : M_PI);
    if (!ground.passable(pose)) continue;
    double seconds = 0.0;
    for (const Arc& arc : steering(ground.start(), pose)) seconds += seconds_of(arc, agility);
    const double left = ground.left(pose);
    if (std::isfinite(left)) ends.emplace_back(seconds + left, pose);
    if (ground.gains_room(pose)) roomy.emplace_back(seconds, pose);
  }
  if (ends.empty()) ends = roomy;
  std::sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Pose> sorted;
  for (const auto& end : ends) sorted.push_back(end.second);
  return sorted;
}

// Some of the ends, the first of them more likely: they may lie behind walls.
std::shared_ptr<ob::GoalStates> some_of(const std::vector<Pose>& ends, const ob::SpaceInformationPtr& information) {
  ompl::RNG random;
  ob::ScopedState<> state(information);
  auto goal = std::make_shared<ob::GoalStates>(information);
  for (std::size_t i = 0; i < kEnds; ++i) {
    const double share = std::pow(random.uniform01(), kFavour);
    set_pose(state.get(), ends[static_cast<std::size_t>(share * static_cast<double>(ends.size()))]);
    goal->addState(state);
  }
  return goal;
}

std::vector<Waypoint> waypoints(og::PathGeometric& path, const SteeredSpace& space, const Agility& agility) {
  Pose pose = pose_of(path.getState(0));
  double seconds = 0.0;
  std::vector<Waypoint> way{{pose.x, pose.y, pose.yaw, 0.0, 0.0}};
  for (std::size_t k = 1; k < path.getStateCount(); ++k) {
    for (const Arc& arc : space.arcs(path.getState(k - 1), path.getState(k))) {
      if (seconds_of(arc, agility) < 1e-3) continue;
      if (way.size() > 1 && direction_of(arc) != way.back().direction) seconds += kReversal;
      const int steps = steps_of(arc, 1.0);
      for (int i = 0; i < steps; ++i) {
        pose = along(pose, part(arc, 1.0 / steps));
        seconds += seconds_of(arc, agility) / steps;
        way.push_back({pose.x, pose.y, pose.yaw, direction_of(arc), seconds});
      }
    }
  }
  return way;
}

}  // namespace

std::vector<Waypoint> ompl_manoeuvre(const Field& field, const Pose& start, const std::vector<Obstacle>& obstacles,
                                     const Footprint& footprint, const Agility& agility, const OmplSettings& settings) {
  const double begun = processor_time(), deadline = begun + settings.limit;
  const ob::PlannerTerminationCondition over([deadline] { return processor_time() >= deadline; });
  Ground ground(field, start, obstacles, footprint, agility);
  const std::vector<Steering> steerings{reeds_shepp(settings.radius), turn_drive_turn};
  const std::vector<Pose> ends = draw_ends(ground, steerings.front(), agility, begun + kDrawing * settings.limit);
  if (ends.empty()) return {};

  auto space = std::make_shared<SteeredSpace>(steerings, agility);
  ob::RealVectorBounds bounds(2);
  bounds.setLow(0, start.x - kReach - kStep), bounds.setHigh(0, start.x + kReach + kStep);
  bounds.setLow(1, start.y - kReach - kStep), bounds.setHigh(1, start.y + kReach + kStep);
  space->setBounds(bounds);
  auto information = std::make_shared<ob::SpaceInformation>(space);
  information->setStateValidityChecker([&ground](const ob::State* state) { return ground.passable(pose_of(state)); });
  information->setMotionValidator(std::make_shared<ClearMotions>(information, *space, ground));
  information->setup();

  auto problem = std::make_shared<ob::ProblemDefinition>(information);
  ob::ScopedState<> state(space);
  set_pose(state.get(), start);
  problem->addStartState(state);
  problem->setOptimizationObjective(std::make_shared<Price>(information, *space, ground));

  const auto planner = std::make_shared<og::RRTConnect>(information);
  std::vector<Waypoint> best;
  double least = std::numeric_limits<double>::infinity();
  while (!over()) {
    problem->setGoal(some_of(ends, information));
    planner->setProblemDefinition(problem);
    planner->setup();
    planner->solve(over);
    if (problem->hasExactSolution()) {
      og::PathGeometric path(*problem->getSolutionPath()->as<og::PathGeometric>());
      if (!path.check()) break;
      og::PathSimplifier(information).simplify(path, over);
      const double total = path.cost(problem->getOptimizationObjective()).value() +
                           std::min(kNoGoal, ground.left(pose_of(path.getStates().back())));
      if (total < least) {
        least = total;
        best = waypoints(path, *space, agility);
      }
    }
    problem->clearSolutionPaths();
    planner->clear();
    space->next_steering();
  }
  return best;
}

}  // namespace navigation_peers
