// How long the frames handed to the radio will still be on the air, learned from the rhythm of acknowledgments.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "adhoc_communication/types.hpp"
#include "transport/air_rate.hpp"

namespace adhoc_communication::transport {

/// The radio sends in the order of the frame counters, so the acknowledgment of one frame says that all before it are
/// off the air; and of two frames that lay in the radio together, the distance of their arrivals is the air time of the
/// second. Keeps one to two frames in the hands of the radio: enough to leave it no gap, few enough that an urgent
/// frame never waits long.
class AirClock {
 public:
  static constexpr std::size_t kMostRemembered = 256;
  static constexpr Time kShortestLead = std::chrono::microseconds(150);  ///< within which a host surely wakes up

  explicit AirClock(std::size_t largest_frame) : largest_frame_(largest_frame) {}

  void transmitted(std::uint64_t counter, std::size_t octets, Time now);
  /// `spacing`: between the arrivals of the frame before and of this one; zero unknown.
  void acknowledged(std::uint64_t counter, Time spacing, Time arrived);
  /// The same where it is not known how long before `now` the frame arrived.
  void acknowledged_late(std::uint64_t counter, Time spacing, Time now);

  /// When a further frame may go to the radio: less than one frame of largest size is ahead of it then.
  Time ready_at() const { return busy_until_ - std::max(rate_.air_time(largest_frame_) / 2, kShortestLead); }
  /// When all that was handed over is off the air.
  Time idle_at() const { return busy_until_; }
  /// False until the rhythm of the radio is known.
  bool calibrated() const { return rate_.calibrated(); }
  const AirRate& rate() const { return rate_; }

 private:
  struct Transmission {
    std::uint64_t counter;
    std::size_t octets;
    Time sent;
    Time gap;  ///< since the hand-over of the frame before
    bool sampled;
  };
  using Transmissions = std::deque<Transmission>;

  Transmissions::iterator first_after(std::uint64_t counter);
  Transmission* find(std::uint64_t counter);
  bool take(std::uint64_t counter);
  Time end_of_rest(Time begin);
  void sample(std::uint64_t counter, Time spacing);

  std::size_t largest_frame_;
  AirRate rate_;
  Time busy_until_{0};
  Transmissions recent_;
  std::uint64_t off_air_ = 0;  ///< the last frame known to be so
};

}  // namespace adhoc_communication::transport
