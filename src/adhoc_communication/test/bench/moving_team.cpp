#include "moving_team.hpp"

#include <algorithm>
#include <cmath>

namespace adhoc_communication::bench {
namespace {

MediumOptions radio(bool contention) {
  MediumOptions medium;
  medium.contention = contention;
  medium.range = MovingTeam::kReach;
  return medium;
}

WaypointOptions square(double side) {
  WaypointOptions square;
  square.width = side;
  square.height = side;
  square.slowest = 0.5;
  square.fastest = 2.0;
  return square;
}

}  // namespace

MovingTeam::MovingTeam(std::size_t robots, double side, const EngineOptions& options, std::uint64_t seed,
                       bool contention)
    : team_(radio(contention), seed), good_since_(robots * robots, Time::max()), lossy_(robots * robots, false) {
  for (std::size_t robot = 0; robot < robots; ++robot) {
    robots_.emplace_back(square(side), seed * 7919 + robot);
    const Position position = robots_.back().at(Time(0));
    team_.add(options, position.x, position.y);
  }
  place_robots();
}

void MovingTeam::step() {
  team_.run_for(kStep);
  place_robots();
}

double MovingTeam::loss_at(double distance) { return std::min(1.0, std::pow(distance / kReach, 4)); }

void MovingTeam::place_robots() {
  std::vector<Position> positions;
  for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
    positions.push_back(robots_[robot].at(team_.now()));
    team_.medium().set_position(robot, positions[robot].x, positions[robot].y);
  }
  for (std::size_t a = 0; a < robots_.size(); ++a) {
    for (std::size_t b = a + 1; b < robots_.size(); ++b) set_link(a, b, distance_between(positions[a], positions[b]));
  }
  ++steps_;
}

void MovingTeam::set_link(std::size_t a, std::size_t b, double distance) {
  const bool heard = distance < kReach;
  const double loss = heard ? loss_at(distance) : 1.0;
  if (heard) {
    team_.medium().set_link_loss(a, b, loss);
  } else if (lossy_[a * robots_.size() + b]) {
    team_.medium().set_link_loss(a, b, std::nullopt);
  }
  lossy_[a * robots_.size() + b] = heard;
  Time& since = good_since(a, b);
  if (loss > kGoodLoss) {
    since = Time::max();
  } else {
    since = std::min(since, team_.now());
    ++good_links_;
  }
}

std::vector<std::size_t> MovingTeam::parts_since(Time begin) const {
  const std::size_t count = robots_.size();
  std::vector<std::size_t> part(count, count);
  std::vector<std::size_t> open;
  for (std::size_t first = 0; first < count; ++first) {
    if (part[first] != count) continue;
    part[first] = first;
    open.push_back(first);
    while (!open.empty()) {
      const std::size_t robot = open.back();
      open.pop_back();
      for (std::size_t other = 0; other < count; ++other) {
        if (part[other] != count) continue;
        if (good_since_[std::min(robot, other) * count + std::max(robot, other)] > begin) continue;
        part[other] = first;
        open.push_back(other);
      }
    }
  }
  return part;
}

double MovingTeam::mean_degree() const {
  return 2.0 * static_cast<double>(good_links_) / static_cast<double>(steps_ * robots_.size());
}

}  // namespace adhoc_communication::bench
