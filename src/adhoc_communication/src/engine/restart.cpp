// A new run of the same host, on an interface that has changed.
#include <stdexcept>

#include "engine/implementation.hpp"

namespace adhoc_communication {

EngineOptions Engine::Implementation::options() const {
  EngineOptions options = options_;
  options.keys = guard_.keys();
  return options;
}

/// Takes over what belongs to the host rather than to the run.
void Engine::Implementation::succeed(Implementation& former, Time now) {
  former.end("the interface has changed", now);
  events_ = std::move(former.events_);
  journal_ = std::move(former.journal_);
  statistics_ = former.statistics_;
  sends_.succeed(former.sends_);
  groups_.succeed(former.groups_);
}

/// Everything that the host waits for, and all robots.
void Engine::Implementation::end(const std::string& reason, Time now) {
  while (const auto id = sends_.first()) finish(*id, false, reason, now);
  for (const SendId id : flood_.take_waiting()) report(SendFinished{id, false, reason, false});
  groups_.end(reason);
  settle_groups(now);
  for (const std::string& robot : directory_.names()) report(RobotLost{robot});
}

void Engine::Implementation::set_keys(std::vector<TeamKey> keys) {
  if (keys.empty() == guard_.seals()) {
    throw std::invalid_argument(guard_.seals() ? "a sealed team cannot be left without a key"
                                               : "an open team cannot be given a key while it works");
  }
  guard_.set_keys(std::move(keys));
}

}  // namespace adhoc_communication
