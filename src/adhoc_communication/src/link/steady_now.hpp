// The clock of the protocol: never set, never goes back.
#pragma once

#include <chrono>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

inline Time steady_now() {
  return std::chrono::duration_cast<Time>(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace adhoc_communication
