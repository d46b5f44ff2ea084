// Relays as a parameter gives them.
#pragma once

#include <string>
#include <vector>

#include "relay/relay_entry.hpp"

namespace XmlRpc {
class XmlRpcValue;
}

namespace adhoc_communication {

/// The value of ~relay, a list of structs. Throws std::invalid_argument with what follows "parameter ~relay = ... ".
std::vector<RelayEntry> parse_relays(const XmlRpc::XmlRpcValue& value);

}  // namespace adhoc_communication
