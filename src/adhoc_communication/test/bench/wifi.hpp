// The simulated radio as Wi-Fi is: one channel that all contend for, frames for everybody at a base rate and once,
// those for one robot at a rate that its distance allows, repeated by the link layer.
#pragma once

#include <cstddef>

#include "rows.hpp"

namespace adhoc_communication::bench {

/// `loss`: of each try. `broadcast`: bit/s of frames for everybody.
MediumOptions wifi(double loss, double broadcast = 6e6);

/// Metres at which a frame for one robot goes at that rate, bit/s.
double distance_at(double bit_rate, const MediumOptions& medium);

/// Seconds for one frame of so many octets at that rate, bit/s, with the mean wait for the channel while nobody else
/// sends. `tries_before` widen the window that the wait is drawn from.
double frame_time(std::size_t octets, double bit_rate, bool unicast, const MediumOptions& medium, int tries_before = 0);

/// The same until a frame for one robot is over: it has arrived, or was tried as often as the link layer does.
double unicast_time(std::size_t octets, double bit_rate, const MediumOptions& medium);

}  // namespace adhoc_communication::bench
