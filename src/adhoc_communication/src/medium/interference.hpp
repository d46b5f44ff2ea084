// Something else that sends on the channel, and understands nothing of it: a microwave oven, a jammer.
#pragma once

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// It destroys each frame, at all receivers, that is on the air while it sends. Nobody senses it.
struct InterferenceOptions {
  Time period{0};    ///< from one begin to the next
  Time duration{0};  ///< for which it sends in each period, from its begin on; 0: never
};

inline bool interferes(const InterferenceOptions& options, Time begin, Time end) {
  if (options.duration <= Time(0)) return false;
  const Time phase = begin % options.period;
  return phase < options.duration || phase + (end - begin) > options.period;
}

}  // namespace adhoc_communication
