#include "multicast/carriage.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {

bool Carriage::knows(const MacAddress& destination, Time now) const {
  const air::AirRate* rate = air_.measured(destination);
  return rate != nullptr && rate->measured_lately(now);
}

bool Carriage::knows_well(const MacAddress& destination, Time now) const {
  return knows(destination, now) && air_.measured(destination)->measured_often();
}

/// Seconds of air for a frame that was measured before.
double Carriage::frame_time(const MacAddress& destination) const {
  return static_cast<double>(air_.undisturbed_frame_time(destination).count()) * 1e-9;
}

/// Until it has arrived. Whoever repeats, the link layer or the engine, a frame is as often lost as a beacon.
double Carriage::tries(const MacAddress& target) const {
  return 1.0 / (1.0 - std::min(neighbors_.beacon_loss(target), routing::kWorstLoss));
}

/// Of a frame for everybody, against one for a neighbour: the median, since on a crowded channel single ones are far
/// off.
double Carriage::slowness() const {
  if (!has_measured_broadcasts()) return 1.0;
  std::vector<double> ratios;
  for (const auto& [address, neighbor] : neighbors_.all()) {
    if (air_.measured(address) != nullptr) ratios.push_back(frame_time(wire::kEverybody) / frame_time(address));
  }
  if (ratios.empty()) return 1.0;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return std::max(1.0, *middle);
}

bool Carriage::flood_pays(std::size_t robots, std::size_t far_members) const {
  return static_cast<double>(robots) * slowness() <= kFramesOfAMember * static_cast<double>(far_members);
}

Way Carriage::way(const std::vector<MacAddress>& targets, std::size_t frames, Time now) const {
  if (!has_measured_broadcasts()) return Way::kBroadcast;
  double all_tries = 0.0;
  for (const MacAddress& target : targets) all_tries += tries(target);
  // Each loss rests on a few beacons, and the greatest of many such numbers is too great: the mean is taken.
  const double by_broadcast = kClearly * frame_time(wire::kEverybody) * all_tries / static_cast<double>(targets.size());
  if (std::all_of(targets.begin(), targets.end(), [&](const auto& target) { return knows(target, now); })) {
    double by_unicasts = 0.0;
    for (const MacAddress& target : targets) by_unicasts += frame_time(target) * tries(target);
    if (by_unicasts < by_broadcast) return Way::kUnicasts;
  }
  const bool settled =
      std::all_of(targets.begin(), targets.end(), [&](const auto& target) { return knows_well(target, now); });
  const double at_best = static_cast<double>((kFastestUnicast * targets.size()).count()) * 1e-9;
  const bool worth_it = targets.size() > 1 && frames >= kWorthATrial && at_best < by_broadcast;
  return !settled && worth_it ? Way::kTrial : Way::kBroadcast;
}

}  // namespace adhoc_communication::multicast
