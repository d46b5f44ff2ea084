// What lies between the radio and a robot takes time: a USB adapter, a bridge, a satellite.
#pragma once

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

struct DelayOptions {
  Time fixed{0};          ///< from the end of a frame on the air until its receiver has it
  Time jitter{0};         ///< at most so much longer, at random
  bool reorders = false;  ///< each frame comes after its own time; otherwise none before an earlier one
};

}  // namespace adhoc_communication
