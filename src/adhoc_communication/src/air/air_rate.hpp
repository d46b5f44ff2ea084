// What frames cost in air, learned from those that have arrived.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::air {

/// Of frames to one neighbour, of those for everybody, or of all.
class AirRate {
 public:
  static constexpr std::size_t kOverheadOctets = 300;  ///< preamble and gaps of a frame, expressed in octets
  static constexpr int kEnoughSamples = 8;
  static constexpr int kEnoughBounds = 64;
  static constexpr std::size_t kLatestSamples = 4;
  static constexpr Time kLatest = std::chrono::seconds(10);  ///< age of a measurement that still tells something

  static constexpr double kSlowest = 8e9 / 1e6;  ///< nanoseconds per octet: the lowest rate of Wi-Fi

  static constexpr double kFastest = 8e9 / 1e9;      ///< no pair of frames of a radio arrives closer together
  static constexpr double kStretched = 8e9 / 54e6;   ///< what jitter makes of a faster radio does no harm
  static constexpr double kJitterBegins = 1.0 / 32;  ///< share of the arrivals that are together
  static constexpr double kJitterEnds = 1.0 / 128;

  static Time fastest_air_time(std::size_t octets) {
    return Time(static_cast<Time::rep>(kFastest * static_cast<double>(octets + kOverheadOctets)));
  }
  static Time slowest_air_time(std::size_t octets) {
    return Time(static_cast<Time::rep>(kSlowest * static_cast<double>(octets + kOverheadOctets)));
  }
  Time air_time(std::size_t octets) const {
    return Time(static_cast<Time::rep>(nanoseconds_per_octet_ * static_cast<double>(octets + kOverheadOctets)));
  }
  /// The same when nobody else sends: others only make it longer, so that is the least of the latest measurements.
  Time undisturbed_air_time(std::size_t octets) const {
    if (jittered()) return air_time(octets);
    const std::size_t count = std::min(taken_, latest_.size());
    const double least =
        count == 0 ? nanoseconds_per_octet_ : *std::min_element(latest_.begin(), latest_.begin() + count);
    return Time(static_cast<Time::rep>(least * static_cast<double>(octets + kOverheadOctets)));
  }
  /// Frames seem to wait for those of others, half of one for each at least.
  bool waits_for_others() const {
    return !jittered() && measured_often() &&
           nanoseconds_per_octet_ >= 1.5 * *std::min_element(latest_.begin(), latest_.end());
  }
  /// Something between the radios and the robots takes now longer, now less long: frames arrive together that cannot
  /// have been on the air together, and others far apart. Of these distances only the least tells of the air. Radios
  /// that are so fast, or aggregate frames, bring them together, too, but hardly stretch the others.
  bool jittered() const { return jittered_; }
  /// By how much measurements for frames of so many octets differ from what is believed, in the mean: radios that
  /// contend for the channel, and repeat frames by themselves, take longer for one than for the next.
  Time deviation(std::size_t octets) const {
    return Time(static_cast<Time::rep>(deviation_ * static_cast<double>(octets + kOverheadOctets)));
  }
  double nanoseconds_per_octet() const { return nanoseconds_per_octet_; }
  bool measured_lately(Time now) const { return taken_ > 0 && now - measured_ < kLatest; }
  /// So often that one disturbed measurement decides nothing.
  bool measured_often() const { return taken_ >= kLatestSamples; }
  /// False until the rhythm of the radio is known.
  bool calibrated() const { return samples_ >= kEnoughSamples || bounds_ >= kEnoughBounds; }

  /// Of a frame and the one before it: whether they arrived closer together than any radio sends them.
  void arrived(bool together);
  /// A frame of so many octets was on the air for that long.
  void sample(std::size_t octets, Time duration, Time now);
  /// It was not longer on the air than that.
  void bound(std::size_t octets, Time longest);

 private:
  /// Decides whether there is jitter, and by that what of the measurements is believed.
  void believe();

  double nanoseconds_per_octet_ = 8e9 / 6e6;  ///< until known better: the slowest rate of 802.11g
  double deviation_ = 0.0;                    ///< of it
  double mean_ = nanoseconds_per_octet_;      ///< of the measurements
  double least_ = nanoseconds_per_octet_;     ///< of them; the older, the less it binds
  double together_ = 0.0;                     ///< share of the latest arrivals
  bool jittered_ = false;
  int samples_ = 0;  ///< no more than are enough, as with bounds_
  int bounds_ = 0;
  std::array<double, kLatestSamples> latest_{};
  std::size_t taken_ = 0;
  Time measured_{0};  ///< the last time
};

}  // namespace adhoc_communication::air
