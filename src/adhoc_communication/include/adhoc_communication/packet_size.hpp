// What of a send counts against EngineOptions::max_packet_size.
#pragma once

#include <cstddef>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// Octets, of the payload as it was before pack().
std::size_t packet_size(const SendRequest& request);

}  // namespace adhoc_communication
