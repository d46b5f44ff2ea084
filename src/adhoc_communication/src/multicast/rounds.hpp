// Rounds of a group packet: frames, then a question to those that get them, whose answers count all frames before it.
#pragma once

#include <cstdint>
#include <optional>

#include "transport/round_trip.hpp"

namespace adhoc_communication::multicast {

class Rounds {
 public:
  explicit Rounds(transport::RoundTrip& round_trip) : round_trip_(round_trip) {}

  std::uint16_t number() const { return number_; }
  int frames() const { return frames_; }  ///< of this round
  void sent() { ++frames_; }

  void close(Time now) {
    frames_ = 0;
    asked_ = now;
    timing_ = true;
    ++number_;
  }
  /// The question of the round closed last waits behind frames, until asked() tells that it is out.
  void ask_later() { asked_.reset(); }
  void asked(Time now) { asked_ = now; }
  /// The round of a question without a frame, which closes it.
  std::uint16_t question() {
    timing_ = false;  // which question is answered is not known any more (Karn)
    return number_++;
  }

  /// Whether an answer of `round` is the first one awaited, to a question asked then.
  bool answered(std::uint16_t round, Time asked, Time now) {
    if (round + 1 != number_) return false;
    if (timing_) round_trip_.sample(now - asked);
    timing_ = false;
    return true;
  }
  /// Until when an answer to the last question may take.
  std::optional<Time> due() const { return asked_ ? std::optional<Time>(*asked_ + patience()) : std::nullopt; }
  bool overdue(Time now) const { return asked_ && now >= *due(); }
  Time patience() const { return round_trip_.timeout(); }

 private:
  transport::RoundTrip& round_trip_;
  std::uint16_t number_ = 1;
  int frames_ = 0;
  std::optional<Time> asked_;  ///< when the last round was closed
  bool timing_ = false;        ///< the next answer to it measures the round trip
};

}  // namespace adhoc_communication::multicast
