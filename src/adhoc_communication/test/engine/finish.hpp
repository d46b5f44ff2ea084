// Waiting for the end of a send.
#pragma once

#include "simulation/team.hpp"

namespace adhoc_communication {

/// Whether the send of the robot has ended, well or not, within `patience`.
inline bool finish(Team& team, std::size_t robot, SendId id, Time patience = std::chrono::seconds(30)) {
  return team.run_until_done([&] { return team.finished(robot, id) != nullptr; }, patience);
}

}  // namespace adhoc_communication
