// The parameter ~timings: a preset of AODV's constants, or a preset and what differs from it.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include "adhoc_communication/timings.hpp"

namespace adhoc_communication {

/// "robots", "rfc3561", or a struct {preset: ..., node_traversal_time: ms, ...} with the members of Timings.
/// Throws std::invalid_argument.
Timings parse_timings(const XmlRpc::XmlRpcValue& value);

}  // namespace adhoc_communication
