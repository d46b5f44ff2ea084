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
  former.outgoing_.end("the interface has changed", now);
  for (const std::string& robot : former.directory_.names()) former.events_.add(RobotLost{robot});
  events_ = std::move(former.events_);
  journal_ = std::move(former.journal_);
  statistics_ = former.statistics_;
  outgoing_.succeed(former.outgoing_);
  groups_.succeed(former.groups_);
}

void Engine::Implementation::set_keys(std::vector<TeamKey> keys) {
  if (keys.empty() == guard_.seals()) {
    throw std::invalid_argument(guard_.seals() ? "a sealed team cannot be left without a key"
                                               : "an open team cannot be given a key while it works");
  }
  guard_.set_keys(std::move(keys));
}

}  // namespace adhoc_communication
