// When the next beacon is due.
#pragma once

#include "adhoc_communication/types.hpp"
#include "random.hpp"

namespace adhoc_communication::presence {

/// Twice the interval before, up to kIdleInterval, while nothing happens; sooner for newcomers.
class BeaconRhythm {
 public:
  static constexpr Time kIdleInterval = std::chrono::seconds(1);
  static constexpr Time kQuiet = std::chrono::seconds(1);           ///< after this long without events beacons back off
  static constexpr Time kGreeting = std::chrono::milliseconds(10);  ///< a newcomer waits at most so long
  static constexpr Time kGreetingPause = std::chrono::milliseconds(50);  ///< between a beacon and a greeting

  BeaconRhythm(Time shortest, Random& random, Time now)
      : shortest_(shortest), random_(random), due_(now), spacing_(shortest), last_happened_(now) {}

  Time due() const { return due_; }
  /// The interval that the beacon of now announces; the next one is due after it.
  Time next(Time now);
  /// Presence is told often again, at once if the next beacon is far.
  void happened(Time now);
  /// Newcomers, and those whose link had failed, are greeted soon, so that both sides know at once that the link works
  /// both ways.
  void greet(Time now);

 private:
  Time shortest_;
  Random& random_;
  Time due_;
  Time last_{-1};
  Time spacing_;
  Time last_happened_;
};

}  // namespace adhoc_communication::presence
