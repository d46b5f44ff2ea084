// Selective repeat towards one neighbour: frames waiting, frames on their way, what is lost, when the link is dead.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "routing/sequence_number.hpp"
#include "transport/frame_queue.hpp"
#include "transport/hop_receiver.hpp"
#include "transport/priorities.hpp"
#include "transport/reliability.hpp"
#include "transport/round_trip.hpp"
#include "transport/silence_odds.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

/// A frame is repeated as soon as a later transmission is acknowledged without it, or when its timer runs out; after
/// `most_resends` repetitions it is given up and left to the end-to-end repetition. The link is dead when nothing at
/// all was heard for kSilence while frames were outstanding, and chance does not explain that.
class HopSender {
 public:
  static constexpr std::uint32_t kSpan = 64;          ///< link sequences that one acknowledgment can cover
  static constexpr std::size_t kMostUnresolved = 48;  ///< transmissions whose fate is open
  static constexpr std::size_t kFewUnresolved = 16;   ///< the same while answers are slow, or none is known
  /// The same for a sparing one whose neighbour has fallen silent: a radio that repeats frames for a neighbour that is
  /// gone has no air for what could find another way.
  static constexpr std::size_t kProbes = 8;
  static constexpr std::size_t kFewProbes = 2;  ///< where hardly a frame was lost before
  /// A silence that no short burst of loss explains.
  static constexpr Time kShortestDoubt = std::chrono::milliseconds(25);
  static constexpr Time kSlowAnswers = std::chrono::milliseconds(15);  ///< of the timer, beyond the shortest round trip
  static constexpr Time kSilence = std::chrono::milliseconds(150);
  static constexpr Time kNoProgress = std::chrono::seconds(1);  ///< heard, but not acknowledging
  static constexpr Time kShortestTimer = std::chrono::milliseconds(10);
  static constexpr Time kLongestTimer = std::chrono::milliseconds(500);
  static constexpr Time kShortestWait = std::chrono::milliseconds(2);  ///< for an answer that was asked for at once
  static constexpr std::size_t kMostLate = 64;  ///< transmissions given up by the timer whose acknowledgment may come

  struct Outgoing {
    wire::FrameType type;
    std::uint32_t link_sequence;
    const Bytes* body;  ///< until the next call
    std::uint8_t priority;
    bool passed_on;  ///< it came from another robot
    std::uint8_t beyond;
    std::uint8_t route;
    bool more;
    bool again;  ///< it was sent before
  };
  /// A frame that the neighbour has.
  struct Passed {
    HopFrame frame;
    std::uint32_t link_sequence;
    Time sent;  ///< for the first time
    int repetitions;
  };

  HopSender(std::uint32_t first_link_sequence, int most_resends)
      : next_link_sequence_(first_link_sequence), most_resends_(most_resends) {}

  /// Timers run no shorter than that.
  void be_patient(Time patience) { patience_ = patience; }
  /// Nobody else is known to send on the channel, so that an answer which is overdue is asked for soon.
  void be_eager(bool eager) { eager_ = eager; }
  /// So long may the neighbour hold its acknowledgments back.
  void expect(const AcknowledgmentDelays& delays) { delays_ = delays; }
  /// The radio may repeat frames by itself, so that those for a neighbour that is gone take long.
  void be_sparing(bool sparing) { sparing_ = sparing; }
  /// Something behind the radios takes now longer, now less long: answers that are slow tell nothing of a crowd.
  void expect_jitter(bool jittered) { jittered_ = jittered; }

  void enqueue(HopFrame frame) { waiting_[frame.priority].push(std::move(frame)); }
  std::size_t waiting() const;
  /// Frames wait, to be sent or to be repeated.
  bool has_more() const { return waiting() > 0 || has_lost(); }

  bool has_resend(std::uint8_t priority) const { return !lost_[priority].empty(); }
  bool has_resend(std::uint8_t priority, const MacAddress& previous_hop) const {
    return first_lost(priority, previous_hop) != lost_[priority].end();
  }
  bool has_waiting(std::uint8_t priority) const { return !waiting_[priority].empty(); }
  bool has_waiting(std::uint8_t priority, const MacAddress& previous_hop) const {
    return waiting_[priority].has(previous_hop);
  }
  /// From whom frames of that priority wait, to be sent or to be repeated.
  void add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const;
  /// Frames from there have not arrived, of turns that come back when they have.
  bool passes_on(const MacAddress& previous_hop) const;
  bool idle() const { return in_flight_.empty() && waiting() == 0; }
  /// As idle(), and no transmission is waited for any more.
  bool settled() const { return idle() && unresolved_.empty(); }
  /// Whether one more transmission fits: a repetition, or a frame with a new link sequence.
  bool may_resend() const { return unresolved_.size() < most_unresolved(); }
  bool may_start() const;
  std::size_t unresolved() const { return unresolved_.size(); }
  /// Nothing more fits, or soon, or an answer is overdue: an acknowledgment is wanted.
  bool pressing() const {
    // Where the radio repeats it, one question arrives.
    const bool soon_full = unresolved_.size() > most_unresolved() * 3 / 4 && !(sparing_ && question_);
    return soon_full || !may_start() || (eager_ && overdue_ > 0);
  }
  /// The latest transmission asks for an acknowledgment at once.
  void ask(std::uint64_t counter, Time now);
  /// That transmission did, and its fate is open.
  bool asked(std::uint64_t counter) const;

  /// The lost frame of that previous hop to repeat next; has_resend() and may_resend() hold.
  Outgoing resend(std::uint8_t priority, const MacAddress& previous_hop, std::uint64_t counter, Time now);
  /// Puts a new frame on its way; may_start() holds.
  Outgoing start(HopFrame frame, std::uint64_t counter, Time now);
  HopFrame take_waiting(std::uint8_t priority, const MacAddress& previous_hop) {
    return waiting_[priority].pop(previous_hop);
  }

  /// True when the acknowledgment resolved something. The frames that are done with are added to `passed`.
  bool acknowledged(const wire::HopAcknowledgment& acknowledgment, Time now, std::vector<Passed>* passed = nullptr);
  void heard(Time now) {
    silent_since_ = now;
    odds_.heard(loss(now).value_or(0.0));
    probing_ = false;
  }
  /// The host called late: silence before now proves nothing.
  void excuse_silence(Time now);
  /// Marks frames whose timer has run out as lost.
  void expire(Time now);
  bool dead(Time now) const;
  /// Drops everything. Acknowledgments that come late still tell how long they take.
  void clear();
  /// As clear(); what was not acknowledged, in the order in which it came from each previous hop.
  std::vector<HopFrame> take_all();

  Time next_deadline() const;
  /// Of the latest transmissions; nothing when there were too few.
  std::optional<double> loss(Time now) const;
  /// Frames are as good as never lost. Answers may be: timers do not count.
  bool reliable() const { return reliability_.reliable(); }
  /// Of the latest transmissions before something was heard last, hardly one went unanswered.
  bool hardly_loses() const { return odds_.hardly_lost(); }
  std::uint64_t given_up() const { return given_up_; }
  /// Of a frame and its acknowledgment; 0 before the first.
  Time least_round_trip() const { return round_trip_.least(); }

 private:
  struct InFlight {
    HopFrame frame;
    int transmissions = 0;
    int timeouts = 0;
    std::uint64_t last_counter = 0;
    Time first_sent{0};
  };
  struct Transmission {
    std::uint64_t counter;
    std::uint32_t link_sequence;
    Time sent;
    Time expires;
    Time latest;        ///< to which frames that follow may put off the expiry
    bool asks = false;  ///< for an acknowledgment at once
  };
  struct Question {
    std::uint64_t counter;
    Time asked;
  };

  using Lost = std::deque<std::uint32_t>;

  Lost::const_iterator first_lost(std::uint8_t priority, const MacAddress& previous_hop) const;
  Outgoing transmit(std::uint32_t link_sequence, InFlight& flight, std::uint64_t counter, Time now);
  void transmission_lost(const Transmission& transmission, bool by_timer);
  void count_outcome(double lost, Time now);
  Time timer() const;
  bool has_lost() const;
  bool answers_question(const Transmission& transmission) const;
  bool window_full() const { return question_ && !probing_ && !may_start(); }
  Time answer_overdue() const;
  bool falls_silent(Time now) const;
  void repeat_oldest(Time now);
  void keep_late(const Transmission& transmission);
  std::size_t most_unresolved() const;
  void sample_round_trip(std::uint64_t counter, Time now);
  Time dead_at() const;
  Time silence() const {
    return std::clamp(6 * std::max(round_trip_.timeout(), patience_), kSilence, kNoProgress + round_trip_.least());
  }

  std::uint32_t next_link_sequence_;
  int most_resends_;
  std::array<FrameQueue, kPriorities> waiting_;
  std::map<std::uint32_t, InFlight, routing::SequenceOrder> in_flight_;
  std::array<Lost, kPriorities> lost_;
  std::deque<Transmission> unresolved_;
  std::deque<Transmission> late_;
  int expiries_ = 0;  ///< of timers since the last acknowledgment
  int overdue_ = 0;   ///< answers that were missed since then, timers included
  bool eager_ = false;
  bool sparing_ = false;   ///< see be_sparing()
  bool jittered_ = false;  ///< see expect_jitter()
  bool probing_ = false;   ///< the neighbour has fallen silent, nothing was heard since, and it is sparing
  Time latest_{0};         ///< when the latest transmission went out
  RoundTrip round_trip_{std::chrono::milliseconds(20), kShortestTimer, kLongestTimer};
  std::optional<Question> question_;  ///< that is not answered
  RoundTrip answer_{std::chrono::milliseconds(20), kShortestWait, kLongestTimer};
  Time patience_{0};
  AcknowledgmentDelays delays_;
  std::optional<Time> waiting_since_;  ///< frames have been outstanding without a break since then
  Time silent_since_{0};
  SilenceOdds odds_;
  Time last_progress_{0};
  Reliability reliability_;
  double loss_ = 0.0;
  int outcomes_ = 0;  ///< that loss_ rests on, no more than matter
  Time last_outcome_{0};
  std::uint64_t given_up_ = 0;
};

}  // namespace adhoc_communication::transport
