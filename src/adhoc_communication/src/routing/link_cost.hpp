// What a hop costs: the transmissions a frame is expected to need (ETX; De Couto et al., MobiCom 2003), in sixteenths.
//
// Only the loss of frames in the direction of the data counts: one acknowledgment covers many frames, so its loss costs
// little. Costs add up along a route. Every link costs something, and what a route table stores of a sequence number
// never grows, so (sequence number, cost) keeps routes free of loops just as (sequence number, hop count) does.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace adhoc_communication::routing {

using Cost = std::uint16_t;

constexpr Cost kPerfectHop = 16;
constexpr double kWorstLoss = 0.9;

inline Cost link_cost(double loss) {
  return static_cast<Cost>(std::lround(kPerfectHop / (1.0 - std::clamp(loss, 0.0, kWorstLoss))));
}

inline Cost sum(Cost a, Cost b) { return static_cast<Cost>(std::min<int>(a + b, 0xffff)); }

constexpr Cost kCheapestDetour = 2 * kPerfectHop;

/// No way round is cheaper than such a link.
inline bool is_unbeatable(Cost link) { return link <= kCheapestDetour; }

}  // namespace adhoc_communication::routing
