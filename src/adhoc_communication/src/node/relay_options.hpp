// Relays as parameters and services give them.
#pragma once

#include <string>
#include <vector>

#include "node/relay_table.hpp"

namespace XmlRpc {
class XmlRpcValue;
}

namespace adhoc_communication {

/// Reads control, position, normal or bulk; an empty text means normal. Throws std::invalid_argument.
Priority parse_priority(const std::string& text);
std::string to_text(Priority priority);

/// The value of ~relay, a list of structs. Throws std::invalid_argument with what follows "parameter ~relay = ... ".
std::vector<RelayEntry> parse_relays(const XmlRpc::XmlRpcValue& value);

/// Throws std::invalid_argument unless both topics are valid ROS names.
void check_topics(const RelayEntry& entry);

}  // namespace adhoc_communication
