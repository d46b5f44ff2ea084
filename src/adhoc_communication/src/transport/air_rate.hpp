// What frames cost in air, learned from those that have arrived.
#pragma once

#include <cstddef>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

/// Of frames to one neighbour, of those for everybody, or of all.
class AirRate {
 public:
  static constexpr std::size_t kOverheadOctets = 300;  ///< preamble and gaps of a frame, expressed in octets
  static constexpr int kEnoughSamples = 8;
  static constexpr int kEnoughBounds = 64;

  Time air_time(std::size_t octets) const {
    return Time(static_cast<Time::rep>(nanoseconds_per_octet_ * static_cast<double>(octets + kOverheadOctets)));
  }
  double nanoseconds_per_octet() const { return nanoseconds_per_octet_; }
  /// False until the rhythm of the radio is known.
  bool calibrated() const { return samples_ >= kEnoughSamples || bounds_ >= kEnoughBounds; }

  /// A frame of so many octets was on the air for that long.
  void sample(std::size_t octets, Time duration);
  /// It was not longer on the air than that.
  void bound(std::size_t octets, Time longest);

 private:
  double nanoseconds_per_octet_ = 8e9 / 6e6;  ///< until known better: the slowest rate of 802.11g
  int samples_ = 0;                           ///< no more than are enough, as with bounds_
  int bounds_ = 0;
};

}  // namespace adhoc_communication::transport
