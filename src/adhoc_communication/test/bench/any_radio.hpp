// What is measured in the same way on any radio.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "rows.hpp"

namespace adhoc_communication::bench {

/// Octets of the frame that brings a hop acknowledgment, behind the Ethernet header.
std::size_t acknowledgment_octets();

/// Bit/s that 20 MB get along a line in steady state: a packet before them has found the route. 0 if one was lost.
/// `spacing`: metres between robots.
double goodput(std::size_t hops, double spacing, const MediumOptions& medium, std::uint64_t seed);

// `on`: the radio's name in the row, after a comma; empty for the usual one.

/// `interval`: between messages of 10 kB over two hops.
Row repair(const MediumOptions& medium, const std::string& on, Time interval, int first_seed, int kills);
Row first_route(const MediumOptions& medium, const std::string& on, int seeds);

}  // namespace adhoc_communication::bench
