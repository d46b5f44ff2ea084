#include "presence/beacon_rhythm.hpp"

#include <algorithm>

namespace adhoc_communication::presence {

Time BeaconRhythm::next(Time now) {
  const bool quiet = now - last_happened_ >= kQuiet;
  spacing_ = quiet ? std::min(2 * spacing_, std::max(shortest_, kIdleInterval)) : shortest_;
  last_ = now;
  // A tenth of randomness keeps the beacons of robots started together from meeting again and again.
  due_ = now + spacing_ * 19 / 20 + random_.delay(spacing_ / 10);
  return spacing_;
}

void BeaconRhythm::happened(Time now) {
  last_happened_ = now;
  if (spacing_ <= shortest_) return;
  spacing_ = shortest_;
  due_ = std::min(due_, now + random_.delay(shortest_));
}

void BeaconRhythm::greet(Time now) {
  const Time earliest = last_ < Time(0) ? now : last_ + kGreetingPause;
  due_ = std::min(due_, std::max(earliest, now + random_.delay(kGreeting)));
}

}  // namespace adhoc_communication::presence
