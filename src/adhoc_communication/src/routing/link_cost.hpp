// What a hop costs: the transmissions a frame is expected to need (ETX; De Couto et al., MobiCom 2003), in sixteenths.
//
// A frame has to arrive, and so has its acknowledgment. (One acknowledgment may cover many frames of a bulk transfer,
// and its loss then costs less; but links lose alike in both directions, mostly, and few packets are bulk.) Costs add
// up along a route. Every link costs something, and what a route table stores of a sequence number never grows, so
// (sequence number, cost) keeps routes free of loops just as (sequence number, hop count) does.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace adhoc_communication::routing {

using Cost = std::uint16_t;

constexpr Cost kPerfectHop = 16;
constexpr double kWorstLoss = 0.9;

/// Of frames that are lost with the probabilities `to` the neighbour and `from` it, 0..1.
inline Cost link_cost(double to, double from) {
  const double delivery = (1.0 - to) * (1.0 - from);
  return static_cast<Cost>(std::lround(kPerfectHop / std::max(delivery, 1.0 - kWorstLoss)));
}

inline Cost sum(Cost a, Cost b) { return static_cast<Cost>(std::min<int>(a + b, 0xffff)); }

constexpr Cost kCheapestDetour = 2 * kPerfectHop;

/// No way round is cheaper than such a link.
inline bool is_unbeatable(Cost link) { return link <= kCheapestDetour; }

/// A way round of two hops that lose less than a third is not cheaper either: no need to look for one.
inline bool is_fair(Cost link) { return link <= 2 * kCheapestDetour; }

}  // namespace adhoc_communication::routing
