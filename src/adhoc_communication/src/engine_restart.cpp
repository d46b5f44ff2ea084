// A new run of the same host, on an interface that has changed.
#include "engine_implementation.hpp"

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
  next_send_id_ = former.next_send_id_;
  memberships_.succeed(former.memberships_);
}

/// Everything that the host waits for, and all robots.
void Engine::Implementation::end(const std::string& reason, Time now) {
  while (!sendings_.empty()) finish(sendings_.begin()->first, false, reason, now);
  for (const SendId id : flood_.take_waiting()) report(SendFinished{id, false, reason, false});
  memberships_.end(reason);
  carry_out_memberships(now);
  for (const std::string& robot : directory_.names()) report(RobotLost{robot});
}

}  // namespace adhoc_communication
