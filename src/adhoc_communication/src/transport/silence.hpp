// How long the receiver of a stream has said nothing, and what was done about it.
#pragma once

#include <algorithm>

#include "adhoc_communication/types.hpp"
#include "random.hpp"

namespace adhoc_communication::transport {

/// It is asked when its answer is overdue, later each time.
class Silence {
 public:
  static constexpr Time kLongestBackoff = std::chrono::seconds(1);
  /// New routes that nothing gets through put off every timer. After so long, more questions than allowed are enough.
  static constexpr Time kNoProgress = std::chrono::seconds(30);
  /// Nothing of a packet has arrived for so long, and so many questions: it is tried in shorter segments.
  static constexpr Time kTooLong = std::chrono::milliseconds(1500);
  static constexpr int kQuestionsBeforeShorter = 3;

  /// Something was acknowledged, or the first packet came.
  void broken(Time now) {
    start_over();
    questions_ = questions_before_ = 0;
    since_ = broken_at_ = now;
  }
  /// Nothing could have been answered before.
  void begins(Time now) { since_ = now; }
  /// Two who do not hear each other and ask at once would collide for ever: each asks a little sooner the next time
  /// than its timer says. `round_trip`: within which an answer comes.
  void asked(Time round_trip, Time now, Random& random) {
    ++resends_;
    ++questions_;
    sooner_ = random.delay(backoff(round_trip) / 3);
    since_ = now;
  }
  void asked_over_another_route() { ++questions_; }
  void start_over() {
    resends_ = 0;
    sooner_ = Time(0);
  }
  void shortened(Time now) {
    shortened_ = now;
    questions_before_ = questions_;
    resends_ = 0;
  }

  Time ends(Time round_trip) const { return since_ + backoff(round_trip) - sooner_; }
  int resends() const { return resends_; }
  /// From when on shorter segments are worth a try.
  Time suggests_shorter_at() const {
    if (questions_ - questions_before_ < kQuestionsBeforeShorter) return Time::max();
    return std::max(broken_at_, shortened_) + kTooLong;
  }
  Time hopeless_at(int most_resends) const {
    return questions_ > most_resends ? broken_at_ + kNoProgress : Time::max();
  }

 private:
  Time backoff(Time round_trip) const {
    return std::min(round_trip * (2 + resends_) / 2, std::max(kLongestBackoff, round_trip));
  }

  int resends_ = 0;
  Time sooner_{0};     ///< the next resend than its backoff
  int questions_ = 0;  ///< since it was broken: resends, and segments repeated over a new route
  Time broken_at_{0};
  Time since_{0};
  Time shortened_{0};         ///< when shorter segments were tried last
  int questions_before_ = 0;  ///< up to then
};

}  // namespace adhoc_communication::transport
