// Counting frames that carry packets.
#pragma once

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

inline void count(DataFrames& frames, bool passed_on, bool again) {
  if (again) {
    ++(passed_on ? frames.passed_on_again : frames.sent_again);
  } else {
    ++(passed_on ? frames.passed_on : frames.sent);
  }
}

}  // namespace adhoc_communication::transport
