// Four robots in a square, 0 - 1 - 3 and 0 - 2 - 3: two relays, and the one that large frames went over last.
#pragma once

#include "simulation/team.hpp"

namespace adhoc_communication {

struct Diamond {
  explicit Diamond(const MediumOptions& medium, std::uint64_t seed) : team(medium, seed) {
    for (const auto& [x, y] : {std::pair(0.0, 0.0), {7.0, 4.0}, {7.0, -4.0}, {14.0, 0.0}}) team.add({}, x, y);
    team.on_transmission = [this](std::size_t robot, const Frame& frame) {
      if ((robot == 1 || robot == 2) && frame.bytes.size() > 1000) relay = robot;
    };
  }
  Diamond(const Diamond&) = delete;
  Diamond& operator=(const Diamond&) = delete;

  Team team;
  std::size_t relay = 0;  ///< 1 or 2; 0 before the first
};

}  // namespace adhoc_communication
