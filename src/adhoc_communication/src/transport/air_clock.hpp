// How long the frames handed to the radio will still be on the air, learned from the rhythm of acknowledgments.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

/// The radio sends in the order of the frame counters, so the acknowledgment of one frame says that all before it are
/// off the air; and of two frames that lay in the radio together, the distance of their arrivals is the air time of the
/// second. Keeps one to two frames in the hands of the radio: enough to leave it no gap, few enough that an urgent
/// frame never waits long.
class AirClock {
 public:
  static constexpr std::size_t kOverheadOctets = 300;  ///< preamble and gaps of a frame, expressed in octets
  static constexpr std::size_t kMostRemembered = 256;
  static constexpr int kEnoughSamples = 8;
  static constexpr int kEnoughBounds = 64;
  static constexpr Time kShortestLead = std::chrono::microseconds(150);  ///< within which a host surely wakes up

  explicit AirClock(std::size_t largest_frame) : largest_frame_(largest_frame) {}

  void transmitted(std::uint64_t counter, std::size_t octets, Time now);
  /// `spacing`: between the arrivals of the frame before and of this one; zero unknown.
  void acknowledged(std::uint64_t counter, Time spacing, Time arrived);
  /// The same where it is not known how long before `now` the frame arrived.
  void acknowledged_late(std::uint64_t counter, Time spacing, Time now);

  /// When a further frame may go to the radio: less than one frame of largest size is ahead of it then.
  Time ready_at() const {
    return busy_until_ - std::max(air_time(largest_frame_ + kOverheadOctets) / 2, kShortestLead);
  }
  /// When all that was handed over is off the air.
  Time idle_at() const { return busy_until_; }
  /// False until the rhythm of the radio is known.
  bool calibrated() const { return samples_ >= kEnoughSamples || bounds_ >= kEnoughBounds; }
  double nanoseconds_per_octet() const { return nanoseconds_per_octet_; }

 private:
  struct Transmission {
    std::uint64_t counter;
    std::size_t octets;
    Time sent;
  };

  Time air_time(std::size_t octets) const {
    return Time(static_cast<Time::rep>(nanoseconds_per_octet_ * static_cast<double>(octets)));
  }
  bool take(std::uint64_t counter, Time spacing);
  Time end_of_rest(Time begin) const;
  void bound(std::size_t octets, Time longest);
  void sample(std::size_t octets, Time duration);

  std::size_t largest_frame_;
  double nanoseconds_per_octet_ = 8e9 / 6e6;  ///< until known better: the slowest rate of 802.11g
  int samples_ = 0;                           ///< no more than are enough, as with bounds_
  int bounds_ = 0;
  Time busy_until_{0};
  std::deque<Transmission> on_air_;
  Transmission before_{};  ///< the last one known to be off the air
};

}  // namespace adhoc_communication::transport
