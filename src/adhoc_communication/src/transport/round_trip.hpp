// RFC 6298: smoothed round trip time and its variation, as a timeout.
//
// What the shortest round trip takes is the way itself: a bridge, an adapter, a satellite. Only what comes on top of it
// tells of queues and of a crowded channel, so bounds count from there.
#pragma once

#include <algorithm>
#include <optional>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

class RoundTrip {
 public:
  RoundTrip(Time initial, Time shortest, Time longest) : initial_(initial), shortest_(shortest), longest_(longest) {}

  void sample(Time round_trip) {
    least_ = std::min(least_, round_trip);
    if (!smoothed_) {
      smoothed_ = round_trip;
      variation_ = round_trip / 2;
      return;
    }
    const Time deviation = round_trip > *smoothed_ ? round_trip - *smoothed_ : *smoothed_ - round_trip;
    variation_ += (deviation - variation_) / 4;
    *smoothed_ += (round_trip - *smoothed_) / 8;
  }
  Time timeout() const {
    return smoothed_ ? std::clamp(*smoothed_ + 4 * variation_, shortest_, longest_ + least_) : initial_;
  }
  /// The shortest one there was; 0 before the first.
  Time least() const { return smoothed_ ? least_ : Time(0); }
  bool known() const { return smoothed_.has_value(); }
  Time variation() const { return variation_; }
  Time smoothed() const { return smoothed_.value_or(initial_); }

 private:
  Time initial_;
  Time shortest_;
  Time longest_;
  std::optional<Time> smoothed_;
  Time variation_{0};
  Time least_ = Time::max();
};

}  // namespace adhoc_communication::transport
