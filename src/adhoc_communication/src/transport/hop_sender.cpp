#include "transport/hop_sender.hpp"

#include <algorithm>
#include <iterator>

#include "transport/turn_taking.hpp"

namespace adhoc_communication::transport {
namespace {

constexpr int kOutcomesThatMatter = 32;
constexpr int kFewestOutcomes = 8;
constexpr double kAnswerMissing = 0.5;  ///< counts as so much of a loss: it may be the answer that was lost
constexpr int kExpiriesPerDoubling = 4;
constexpr int kAnswersMissed = 8;           ///< in a row, that a lossy link explains
constexpr std::size_t kManyUnresolved = 4;  ///< so that acknowledgments may be held back
constexpr Time kOutcomesAge = std::chrono::seconds(10);

}  // namespace

std::size_t HopSender::waiting() const {
  std::size_t count = 0;
  for (const auto& queue : waiting_) count += queue.size();
  return count;
}

bool HopSender::has_lost() const {
  return std::any_of(lost_.begin(), lost_.end(), [](const auto& lost) { return !lost.empty(); });
}

/// More of them would crowd a crowded channel until it carries nothing but repetitions.
std::size_t HopSender::most_unresolved() const {
  if (probing_) return hardly_loses() ? kFewProbes : kProbes;
  const bool crowded = !jittered_ && round_trip_.timeout() - round_trip_.least() >= kSlowAnswers;
  return crowded ? kFewUnresolved : kMostUnresolved;
}

bool HopSender::may_start() const {
  if (unresolved_.size() >= most_unresolved()) return false;
  return in_flight_.empty() || next_link_sequence_ - in_flight_.begin()->first < kSpan;
}

void HopSender::add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const {
  waiting_[priority].add_hops(hops);
  for (const std::uint32_t lost : lost_[priority]) hops.push_back(in_flight_.at(lost).frame.previous_hop);
}

bool HopSender::passes_on(const MacAddress& previous_hop) const {
  const auto is_one = [&](const HopFrame& frame) {
    return frame.previous_hop == previous_hop && TurnTaking::comes_back(frame.route);
  };
  const auto flies = [&](const auto& item) { return is_one(item.second.frame); };
  const auto waits = [&](const FrameQueue& queue) {
    return queue.has(previous_hop) && is_one(queue.first(previous_hop));
  };
  return std::any_of(in_flight_.begin(), in_flight_.end(), flies) ||
         std::any_of(waiting_.begin(), waiting_.end(), waits);
}

HopSender::Lost::const_iterator HopSender::first_lost(std::uint8_t priority, const MacAddress& previous_hop) const {
  return std::find_if(lost_[priority].begin(), lost_[priority].end(), [&](std::uint32_t link_sequence) {
    return in_flight_.at(link_sequence).frame.previous_hop == previous_hop;
  });
}

HopSender::Outgoing HopSender::resend(std::uint8_t priority, const MacAddress& previous_hop, std::uint64_t counter,
                                      Time now) {
  const auto lost = first_lost(priority, previous_hop);
  const std::uint32_t link_sequence = *lost;
  lost_[priority].erase(lost);
  return transmit(link_sequence, in_flight_.at(link_sequence), counter, now);
}

HopSender::Outgoing HopSender::start(HopFrame frame, std::uint64_t counter, Time now) {
  if (!waiting_since_) {
    waiting_since_ = now;
    last_progress_ = now;
  }
  const std::uint32_t link_sequence = next_link_sequence_++;
  InFlight& flight = in_flight_[link_sequence];
  flight.frame = std::move(frame);
  flight.first_sent = now;
  return transmit(link_sequence, flight, counter, now);
}

HopSender::Outgoing HopSender::transmit(std::uint32_t link_sequence, InFlight& flight, std::uint64_t counter,
                                        Time now) {
  ++flight.transmissions;
  flight.last_counter = counter;
  latest_ = now;
  // The receiver may hold its acknowledgment back while further frames come.
  for (Transmission& earlier : unresolved_) {
    if (unresolved_.size() < kManyUnresolved) break;
    earlier.expires = std::max(earlier.expires, std::min(now + timer(), earlier.latest));
  }
  const int backoff = std::min(flight.timeouts, 5);
  const Time expires = now + std::max(timer() * (5 + backoff) / 5, patience_);
  unresolved_.push_back({counter, link_sequence, now, expires, expires + delays_.longest});
  const bool again = flight.transmissions > 1 || flight.frame.again;
  const HopFrame& frame = flight.frame;
  const bool passed_on = frame.previous_hop != MacAddress{};
  return {frame.type,   link_sequence, &frame.body, frame.priority, passed_on,
          frame.beyond, frame.route,   frame.more,  again};
}

/// Timers that run out again and again say that the channel is crowded and acknowledgments come late: repeating would
/// crowd it more.
Time HopSender::timer() const {
  const Time longest = kLongestTimer + round_trip_.least();
  return std::min(round_trip_.timeout() * (1 << std::min(expiries_ / kExpiriesPerDoubling, 6)), longest);
}

void HopSender::ask(std::uint64_t counter, Time now) {
  question_ = {counter, now};
  unresolved_.back().asks = true;
}

bool HopSender::asked(std::uint64_t counter) const {
  return std::any_of(unresolved_.begin(), unresolved_.end(), [counter](const Transmission& transmission) {
    return transmission.asks && transmission.counter == counter;
  });
}

/// Tells how long answers take, which one to a later frame does not.
bool HopSender::answers_question(const Transmission& transmission) const {
  if (eager_) return transmission.asks;
  return question_ && question_->counter == transmission.counter;
}

/// A late acknowledgment counts, too: otherwise a timer that is too short would stay so.
void HopSender::sample_round_trip(std::uint64_t counter, Time now) {
  for (const auto* sent : {&unresolved_, &late_}) {
    for (const Transmission& transmission : *sent) {
      if (transmission.counter != counter) continue;
      if (answers_question(transmission)) answer_.sample(now - transmission.sent);
      return round_trip_.sample(now - transmission.sent);
    }
  }
}

bool HopSender::acknowledged(const wire::HopAcknowledgment& acknowledgment, Time now, std::vector<Passed>* passed) {
  bool progress = false;
  for (auto iterator = in_flight_.begin(); iterator != in_flight_.end();) {
    const std::uint32_t behind = acknowledgment.highest - iterator->first;
    if (behind < kSpan && (acknowledgment.received >> behind & 1) != 0) {
      auto& lost = lost_[iterator->second.frame.priority];
      lost.erase(std::remove(lost.begin(), lost.end(), iterator->first), lost.end());
      InFlight& flight = iterator->second;
      if (passed != nullptr) {
        passed->push_back({std::move(flight.frame), iterator->first, flight.first_sent, flight.transmissions - 1});
      }
      iterator = in_flight_.erase(iterator);
      progress = true;
    } else {
      ++iterator;
    }
  }
  sample_round_trip(acknowledgment.newest_counter, now);
  if (question_ && question_->counter <= acknowledgment.newest_counter) question_.reset();
  while (!unresolved_.empty() && unresolved_.front().counter <= acknowledgment.newest_counter) {
    const Transmission transmission = unresolved_.front();
    unresolved_.pop_front();
    const bool lost = in_flight_.count(transmission.link_sequence) != 0;
    count_outcome(lost ? 1.0 : 0.0, now);
    reliability_.count(lost);
    if (lost) transmission_lost(transmission, false);
    progress = true;
  }
  while (!late_.empty() && late_.front().counter <= acknowledgment.newest_counter) late_.pop_front();
  if (progress) {
    last_progress_ = now;
    expiries_ = 0;
    overdue_ = 0;
  }
  if (in_flight_.empty()) {
    waiting_since_.reset();
    unresolved_.clear();
  }
  return progress;
}

void HopSender::excuse_silence(Time now) {
  silent_since_ = std::max(silent_since_, now);
  last_progress_ = std::max(last_progress_, now);
  latest_ = std::max(latest_, now);
  for (Transmission& transmission : unresolved_) {
    transmission.expires = std::max(transmission.expires, now + kShortestTimer);
  }
}

/// Of the window that is full, so that nothing else could be sent meanwhile: twice as late each time after several
/// where the radio may repeat, or it would be full of repetitions for a neighbour that is gone. Or of the latest
/// transmission, which the receiver acknowledges when no other one follows: twice as late each time, until that is no
/// sooner than the timer.
Time HopSender::answer_overdue() const {
  if (unresolved_.empty() || has_lost()) return Time::max();
  if (window_full()) {
    const int doublings = sparing_ ? std::clamp(overdue_ - kAnswersMissed, 0, 6) : 0;
    return question_->asked + std::max(answer_.timeout() * (1 << doublings), patience_);
  }
  const Time wait = answer_.timeout() * (1 << std::min(overdue_, 6));
  if (!eager_ || wait >= timer()) return Time::max();
  return latest_ + (unresolved_.back().asks ? Time(0) : delays_.quiet) + wait;
}

/// It is the most likely one to be missing, and its repetition asks again.
void HopSender::repeat_oldest(Time now) {
  const bool full = window_full();
  const Transmission transmission = unresolved_.front();
  unresolved_.pop_front();
  question_.reset();
  keep_late(transmission);
  if (!full) count_outcome(kAnswerMissing, now);
  ++overdue_;
  transmission_lost(transmission, false);
}

void HopSender::keep_late(const Transmission& transmission) {
  if (late_.size() == kMostLate) late_.pop_front();
  late_.push_back(transmission);
}

/// Where hardly a frame is lost, sooner than a timer tells: so long no answer takes that is held back for further
/// frames.
bool HopSender::falls_silent(Time now) const {
  if (!sparing_ || !hardly_loses() || unresolved_.empty()) return false;
  const Time silent_since = std::max(silent_since_, unresolved_.front().sent);
  return now - silent_since >= std::max({round_trip_.timeout() / 2, delays_.longest, kShortestDoubt});
}

void HopSender::expire(Time now) {
  probing_ = probing_ || falls_silent(now);
  if (answer_overdue() <= now) repeat_oldest(now);
  for (auto iterator = unresolved_.begin(); iterator != unresolved_.end();) {
    if (iterator->expires > now) {
      ++iterator;
      continue;
    }
    const Transmission transmission = *iterator;
    iterator = unresolved_.erase(iterator);
    keep_late(transmission);
    ++expiries_;
    ++overdue_;
    count_outcome(1.0, now);
    transmission_lost(transmission, true);
    probing_ = probing_ || (sparing_ && now - silent_since_ >= round_trip_.timeout());
  }
  if (in_flight_.empty()) waiting_since_.reset();  // given up: nothing is outstanding any more
}

void HopSender::transmission_lost(const Transmission& transmission, bool by_timer) {
  const auto found = in_flight_.find(transmission.link_sequence);
  if (found == in_flight_.end() || found->second.last_counter != transmission.counter) return;
  InFlight& flight = found->second;
  if (by_timer) ++flight.timeouts;
  if (flight.transmissions > most_resends_) {
    in_flight_.erase(found);
    ++given_up_;
    return;
  }
  lost_[flight.frame.priority].push_back(transmission.link_sequence);
}

Time HopSender::dead_at() const {
  if (!waiting_since_) return Time::max();
  const Time no_progress = kNoProgress + round_trip_.least();
  const Time silent_since = std::max(*waiting_since_, silent_since_);
  return std::min(silent_since + (odds_.tells() ? silence() : no_progress), last_progress_ + no_progress);
}

bool HopSender::dead(Time now) const { return dead_at() <= now; }

void HopSender::clear() {
  for (auto& queue : waiting_) queue.clear();
  for (auto& queue : lost_) queue.clear();
  in_flight_.clear();
  for (const Transmission& transmission : unresolved_) keep_late(transmission);
  unresolved_.clear();
  expiries_ = 0;
  overdue_ = 0;
  probing_ = false;
  question_.reset();
  waiting_since_.reset();
}

std::vector<HopFrame> HopSender::take_all() {
  std::vector<HopFrame> frames;
  for (auto& [link_sequence, flight] : in_flight_) frames.push_back(std::move(flight.frame));
  for (FrameQueue& queue : waiting_) queue.move_all_to(frames);
  clear();
  return frames;
}

void HopSender::count_outcome(double lost, Time now) {
  outcomes_ = now - last_outcome_ < kOutcomesAge ? std::min(outcomes_ + 1, kOutcomesThatMatter) : 1;
  last_outcome_ = now;
  if (lost > 0.0) odds_.unanswered();
  loss_ += (lost - loss_) / outcomes_;
}

std::optional<double> HopSender::loss(Time now) const {
  if (outcomes_ < kFewestOutcomes || now - last_outcome_ >= kOutcomesAge) return std::nullopt;
  return loss_;
}

Time HopSender::next_deadline() const {
  Time next = std::min(dead_at(), answer_overdue());
  for (const Transmission& transmission : unresolved_) next = std::min(next, transmission.expires);
  return next;
}

}  // namespace adhoc_communication::transport
