// The counters of the engine as rows of the summaries of the contract.
#pragma once

#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// All frames but those of groups. `time`: Unix milliseconds.
std::string unicast_row(const Statistics& statistics, long long time);

/// Frames of groups: trees grow from their roots, so there are no requests and replies. `time`: Unix milliseconds.
std::string multicast_row(const Statistics& statistics, long long time);

}  // namespace adhoc_communication
