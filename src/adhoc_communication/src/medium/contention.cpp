#include "medium/contention.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {

void ContendedChannel::begin(FrameId frame, Node sender, Time start, Time end, const Reach& reach) {
  Transmission transmission{frame, sender, start, end, {}};
  for (Transmission& other : on_air_) {
    if (other.end <= start || !reach.may_meet(sender, other.sender)) continue;
    other.overlapping.push_back(sender);
    transmission.overlapping.push_back(other.sender);
  }
  on_air_.push_back(std::move(transmission));
}

std::vector<ContendedChannel::Node> ContendedChannel::end(FrameId frame) {
  const auto ended = std::find_if(on_air_.begin(), on_air_.end(),
                                  [frame](const Transmission& transmission) { return transmission.frame == frame; });
  std::vector<Node> overlapping = std::move(ended->overlapping);
  on_air_.erase(ended);
  return overlapping;
}

void ContendedChannel::silence(Node sender, Time now) {
  for (Transmission& transmission : on_air_) {
    if (transmission.sender == sender) transmission.end = std::min(transmission.end, now);
  }
}

Time ContendedChannel::sensed_until(Node listener, Time now, Reach& reach) const {
  Time until = now;
  for (const Transmission& transmission : on_air_) {
    const bool can_be_sensed = transmission.start < now && transmission.end > until;
    if (can_be_sensed && reach.hearer(transmission.sender, listener) != nullptr) until = transmission.end;
  }
  return until;
}

}  // namespace adhoc_communication
