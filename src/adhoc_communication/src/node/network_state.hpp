// What the node tells of itself, as messages.
#pragma once

#include <adhoc_communication/NetworkState.h>
#include <adhoc_communication/Status.h>

#include <vector>

#include "node/engine_host.hpp"
#include "node/injector.hpp"
#include "relay/relay_table.hpp"

namespace adhoc_communication {

/// What does not come from the engine.
struct NodeState {
  ros::Time stamp;
  std::string robot_name;
  std::string interface;
  MacAddress address{};
  bool sealed = false;
  std::vector<RelayReport> relays;
  Injector::Report injector;
  std::uint64_t log_rows_lost = 0;
  std::uint64_t frames_not_captured = 0;
};

Status status_message(const Snapshot& snapshot, const NodeState& node);
NetworkState network_state_message(const Snapshot& snapshot, const NodeState& node);
RelayedTopic relayed_topic_message(const RelayReport& report);

}  // namespace adhoc_communication
