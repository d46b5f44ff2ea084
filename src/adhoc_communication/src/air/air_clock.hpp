// How long the frames handed to the radio will still be on the air, learned from the rhythm of acknowledgments.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "address_map.hpp"
#include "adhoc_communication/types.hpp"
#include "air/air_rate.hpp"
#include "air/shared_air.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::air {

/// The radio sends in the order of the frame counters, so the acknowledgment of one frame says that all before it are
/// off the air; and of two frames that lay in the radio together, the distance of their arrivals is the air time of the
/// second. Keeps one to two frames in the hands of the radio: enough to leave it no gap, few enough that an urgent
/// frame never waits long. On Wi-Fi frames for everybody go at a slow base rate, and those to each neighbour at one of
/// their own.
class AirClock {
 public:
  static constexpr std::size_t kMostRemembered = 256;
  static constexpr int kPairInterval = 64;         ///< of so many frames to one destination, two measure the air
  static constexpr int kPairIntervalInJitter = 8;  ///< the same where most of what they measure tells nothing
  static constexpr int kEnoughDelays = 8;          ///< measured, of which the least is taken
  static constexpr int kDeviations = 8;            ///< of the time that a frame takes, that the radio may be ahead
  static constexpr int kMostAhead = 4;             ///< frames of largest size, of those
  static constexpr Time kShortestLead = std::chrono::microseconds(150);  ///< within which a host surely wakes up

  explicit AirClock(std::size_t largest_frame) : largest_frame_(largest_frame) {}
  AirClock(const AirClock&) = delete;
  AirClock& operator=(const AirClock&) = delete;

  /// `destination`: a neighbour, or wire::kEverybody; `category`: the queue of the radio.
  void transmitted(std::uint64_t counter, std::size_t octets, const MacAddress& destination, Time now,
                   AccessCategory category = AccessCategory::kBestEffort);
  /// Whether the device has something left of what was transmitted since the last call; if it is never told, it has
  /// not.
  void handed_over(bool kept);
  /// `spacing`: between the arrivals of the frame before and of this one; zero unknown. `answered`: when the answer was
  /// here, less the time for which it was held back; the answer was a frame of so many octets, 0 if that is not known.
  void acknowledged(std::uint64_t counter, Time spacing, Time answered, std::size_t octets);
  /// The same where it is not known how long before `now` the frame arrived.
  void acknowledged_late(std::uint64_t counter, Time spacing, Time now);
  /// Of neighbours that are gone nothing is remembered.
  template <typename Predicate>
  void forget_unless(const Predicate& is_known) {
    for (auto kind = kinds_.begin(); kind != kinds_.end();) {
      const bool stays = kind->first == wire::kEverybody || is_known(kind->first);
      kind = stays ? std::next(kind) : kinds_.erase(kind);
    }
    last_rate_ = &rate(last_destination_);
  }

  /// When a further frame may go to the radio: less than one frame of largest size is ahead of it then, and of a radio
  /// that takes now longer, now less long, as one that repeats frames by itself, as many as it may be done with sooner
  /// than believed.
  Time ready_at() const { return busy_until_ - std::max(lead(), kShortestLead); }
  /// The radio takes now longer, now less long, so that several frames are in its hands all the time.
  bool varies() const { return lead() > last_rate_->air_time(largest_frame_); }
  /// When all that was handed over is off the air.
  Time idle_at() const { return busy_until_; }
  /// What is believed of frames to a neighbour, or to everybody; of a kind that was never measured, what is of all.
  const AirRate& rate(const MacAddress& destination) const;
  /// Something behind the radios takes now longer, now less long for frames that go there.
  bool jittered(const MacAddress& destination) const { return rate(destination).jittered(); }
  /// Null if it never was measured.
  const AirRate* measured(const MacAddress& destination) const;
  /// Air time of a frame of largest size when nobody else sends.
  Time undisturbed_frame_time(const MacAddress& destination) const {
    return rate(destination).undisturbed_air_time(largest_frame_);
  }
  /// Whether others send on the same channel.
  bool shared(Time now) const { return shared_.shared(now); }
  /// Nothing says that they do.
  bool alone(Time now) const { return !shared_.perhaps_shared(now); }
  /// False until the rhythm of the radio is known for frames that go there.
  bool calibrated(const MacAddress& destination) const;
  /// Nothing has told yet what else than the air the way of a frame takes, and the answer to one that goes there now
  /// would, if it is not put off.
  bool asks_for_delay(const MacAddress& destination, Time now) const {
    return delays_ < kEnoughDelays && busy_until_ <= now && calibrated(destination);
  }
  /// Of so many frames that go there, two measure the air.
  int pair_interval(const MacAddress& destination) const {
    if (!calibrated(destination)) return 2;
    return jittered(destination) ? kPairIntervalInJitter : kPairInterval;
  }

 private:
  struct Transmission {
    std::uint64_t counter;
    std::size_t octets;
    MacAddress destination;
    AccessCategory category;
    Time sent;
    Time gap;       ///< since the hand-over of the frame before
    bool in_order;  ///< behind that in the same queue of the radio
    bool sampled;
    bool kept;  ///< by the device
    Time end;   ///< of its time on the air, as believed
    bool idle;  ///< the radio had nothing else to send, as believed
  };
  using Transmissions = std::deque<Transmission>;

  Time lead() const {
    const Time frame = last_rate_->air_time(largest_frame_);
    return frame / 2 + std::min(kDeviations * last_rate_->deviation(largest_frame_), kMostAhead * frame);
  }
  Transmissions::iterator first_after(std::uint64_t counter);
  Transmission* find(std::uint64_t counter);
  bool take(std::uint64_t counter);
  Time credible(const Transmission& transmission, Time spacing, Time answered) const;
  Time end_of_rest(Time begin);
  Time arrival(const Transmission& last, Time answered, std::size_t octets) const;
  void sample_delay(const Transmission& last, Time answered, std::size_t octets);
  void sample(std::uint64_t counter, Time spacing, Time now);
  void bound(const Transmission& transmission, Time longest);

  std::size_t largest_frame_;
  AirRate common_;             ///< of all frames, whatever their kind
  AddressMap<AirRate> kinds_;  ///< those measured, wire::kEverybody among them
  SharedAir shared_;
  Time busy_until_{0};
  /// The shortest time between frame and answer that neither of them was on the air for: something between the radios
  /// and the robots takes it.
  Time delay_ = Time::max();
  int delays_ = 0;  ///< that were measured, no more than are enough
  Transmissions recent_;
  std::uint64_t handed_over_ = 0;  ///< the last frame of which it is known whether it was kept
  std::uint64_t off_air_ = 0;      ///< the last frame known to be so
  MacAddress last_destination_ = wire::kEverybody;
  const AirRate* last_rate_ = &common_;  ///< of frames that go there
};

}  // namespace adhoc_communication::air
