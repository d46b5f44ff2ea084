// Which way a frame for several neighbours costs less air: once for everybody, or to each of them by itself.
//
// On Wi-Fi the former goes at a slow base rate and is never repeated, the latter at the rate of the pair.
#pragma once

#include <cstddef>
#include <vector>

#include "air/air_clock.hpp"
#include "routing/neighbors.hpp"

namespace adhoc_communication::multicast {

enum class Way {
  kBroadcast,
  kUnicasts,
  kTrial,  ///< a few unicasts, that their cost becomes known
};

class Carriage {
 public:
  /// A broadcast reaches also those whose word that they miss something was lost: at about the same cost it is better.
  static constexpr double kClearly = 0.95;
  /// Air time of the fastest unicast that is thought of: a full frame at 54 Mbit/s, with the gaps around it.
  static constexpr Time kFastestUnicast = std::chrono::microseconds(300);
  static constexpr std::size_t kWorthATrial = 32;  ///< frames still to be sent
  static constexpr double kFramesOfAMember = 5.0;  ///< of a tree, its building and reports among them

  Carriage(const air::AirClock& air, const routing::Neighbors& neighbors) : air_(air), neighbors_(neighbors) {}

  /// For one of `frames` that are still to be sent to these neighbours, one at least.
  Way way(const std::vector<MacAddress>& targets, std::size_t frames, Time now) const;
  /// Whether a frame that each of `robots` may pass on costs less than a tree, or copies, for the members that do not
  /// hear the root: the others have it from the root's own frame either way.
  bool flood_pays(std::size_t robots, std::size_t far_members) const;
  /// What a broadcast costs has been measured, and lately.
  bool has_measured_broadcasts() const { return air_.measured(wire::kEverybody) != nullptr; }
  bool knows_broadcasts(Time now) const { return knows(wire::kEverybody, now); }

 private:
  bool knows(const MacAddress& destination, Time now) const;
  bool knows_well(const MacAddress& destination, Time now) const;
  double frame_time(const MacAddress& destination) const;
  double tries(const MacAddress& target) const;
  double slowness() const;

  const air::AirClock& air_;
  const routing::Neighbors& neighbors_;
};

}  // namespace adhoc_communication::multicast
