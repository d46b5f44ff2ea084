// What the acknowledged segments of a stream tell of the others.
#pragma once

#include <algorithm>
#include <utility>

#include "adhoc_communication/types.hpp"
#include "transport/round_trip.hpp"

namespace adhoc_communication::transport {

/// How long segments take, and which are overtaken by so many that they are lost. Times are when one was sent last.
class Arrivals {
 public:
  /// A segment overtaken by more than this is lost; more on ways that turned out to delay segments for longer.
  static constexpr Time kReordering = std::chrono::milliseconds(50);
  static constexpr Time kMostReordering = std::chrono::seconds(1);

  void acknowledged(Time sent, bool repeated, Time now) {
    if (repeated) return acknowledged_repeated(sent, now);
    newest_doubtful_ = Time(-1);
    if (sent <= newest_) {
      reordering_ = std::clamp(newest_ - sent, reordering_, kMostReordering);
      return;
    }
    newest_ = sent;
    // With a timer that ran out in between, the time is that of the timer (Karn).
    if (sent > asked_) round_trip_.sample(now - sent);
  }
  /// Hops repeat frames and so change their order a little; what is overtaken by much more than that is lost.
  /// On a long way that means little: a quarter of the round trip is tolerated there (RFC 8985).
  bool overtaken(Time sent) const {
    const Time round_trip = round_trip_.known() ? round_trip_.smoothed() : Time(0);
    return sent + std::max(reordering_, round_trip / 4) < newest_;
  }
  /// First copies would have been followed by others: it was the repetition that arrived.
  void nothing_followed() { newest_ = std::max(newest_, std::exchange(newest_doubtful_, Time(-1))); }
  void asked(Time now) { asked_ = now; }
  /// By another run of the receiver.
  void forget() { newest_ = newest_doubtful_ = Time(-1); }
  /// What the way takes at least, there and back, as far as it is known: answers that cannot be here are not overdue.
  void expect(Time way) { way_ = way; }
  Time timeout() const {
    return round_trip_.known() ? round_trip_.timeout() : std::max(round_trip_.timeout(), 2 * way_);
  }

 private:
  /// Soon after the repetition it is the first copy that has arrived, late but not lost: taken for the second, it would
  /// make all that is on the way look overtaken.
  void acknowledged_repeated(Time sent, Time now) {
    if (now - sent >= round_trip_.smoothed() / 2) {
      newest_ = std::max(newest_, sent);
      reordering_ = std::max(reordering_ - reordering_ / 16, kReordering);
      return;
    }
    newest_doubtful_ = std::max(newest_doubtful_, sent);
    if (sent <= widened_) return;
    widened_ = now;
    reordering_ = std::min(reordering_ * 3 / 2, kMostReordering);
  }

  Time newest_{-1};           ///< of those that have arrived
  Time newest_doubtful_{-1};  ///< of repeated segments of which perhaps only the first copy has arrived
  Time asked_{-1};            ///< when the timer ran out last
  Time reordering_ = kReordering;
  Time widened_{-1};  ///< when reordering_ grew
  Time way_{0};       ///< until the round trip is known
  RoundTrip round_trip_{std::chrono::milliseconds(300), std::chrono::milliseconds(150), std::chrono::seconds(1)};
};

}  // namespace adhoc_communication::transport
