// A relay as parameters and services ask for it.
#pragma once

#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// One local topic carried to one destination.
struct RelayEntry {
  std::string topic;
  std::string destination;  ///< robot, mc_<robot>, or empty for a one-hop broadcast
  Priority priority = Priority::kNormal;
  double rate = 0.0;         ///< messages per second at most; 0: every message
  bool latched = false;      ///< the last message is sent to a destination that appears
  std::string remote_topic;  ///< as the receiver publishes it; empty: `topic`
  double lifetime = 0.0;     ///< seconds after which a message is of no use any more; 0: none
  bool newest_only = false;  ///< a newer message takes the place of one that is not on its way yet
};

/// Reads control, position, normal or bulk; an empty text means normal. Throws std::invalid_argument.
Priority parse_priority(const std::string& text);
std::string to_text(Priority priority);

/// Throws std::invalid_argument unless both topics are valid ROS names.
void check_topics(const RelayEntry& entry);

}  // namespace adhoc_communication
