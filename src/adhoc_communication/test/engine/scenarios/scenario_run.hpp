// Plays a scenario and checks the engine's promises after every event.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scenario.hpp"

namespace adhoc_communication {

struct RunOptions {
  std::uint64_t most_events = UINT64_MAX;  ///< the run ends there
  bool trace = false;                      ///< print every event
};

struct Outcome {
  std::uint64_t events = 0;  ///< frames taken and polls
  std::size_t sends = 0;
  std::size_t deliveries = 0;
  std::uint64_t trace_hash = 0;
  double room_taken = 0.0;  ///< of that for packets being put together, by the fullest robot, 0..1
  std::string violation;    ///< empty: all promises were kept
  std::string tail;         ///< the events before the violation
};

Outcome run(const Scenario& scenario, const RunOptions& options = {});

}  // namespace adhoc_communication
