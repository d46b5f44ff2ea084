#include "transport/hop_receiver.hpp"

#include <algorithm>

namespace adhoc_communication::transport {
namespace {

/// Fewer are acknowledged soon: what is not may go a second way if the link dies.
constexpr int kFewFrames = 3;

constexpr int kQuietFrames = 8;
constexpr Time kTogether(1);  ///< 0 is a spacing that is not known
constexpr int kFramesHeldBack = 3 * kQuietFrames;

}  // namespace

AcknowledgmentDelays AcknowledgmentDelays::of(Time frame) {
  AcknowledgmentDelays delays;
  delays.longest = std::clamp(kFramesHeldBack * frame, kLongest, kMostHeld);
  delays.quiet = std::clamp(kQuietFrames * frame, kQuiet, delays.longest);
  return delays;
}

bool HopReceiver::take(std::uint32_t link_sequence, std::uint64_t counter, bool acknowledge_now, Time now) {
  bool gap = false;
  const bool fresh = mark(link_sequence, gap);
  const bool single = now - newest_arrival_ >= delays_.quiet;
  if (counter > newest_counter_) {
    spacing_ = counter == newest_counter_ + 1 ? std::max(now - newest_arrival_, kTogether) : Time(0);
    newest_counter_ = counter;
    newest_arrival_ = now;
  } else if (counter + 1 == newest_counter_) {
    spacing_ = kTogether;  // it was overtaken
  }
  if (unacknowledged_ == 0) owed_since_ = now;
  ++unacknowledged_;
  const bool now_due =
      gap_ripe(gap, now) || (gap && single) || acknowledge_now || !fresh || unacknowledged_ >= kFramesPerAcknowledgment;
  if (due_ <= now) return fresh;
  const Time longest = unacknowledged_ < kFewFrames ? delays_.quiet : delays_.longest;
  due_ = now_due ? now : std::min(now + delays_.quiet, owed_since_ + longest);
  if (gap_since_) due_ = std::min(due_, *gap_since_ + kGapDelay);
  return fresh;
}

bool HopReceiver::gap_ripe(bool gap, Time now) {
  if (gap_since_) return ++frames_since_gap_ >= kFramesAfterGap;
  if (gap) gap_since_ = now;
  frames_since_gap_ = 0;
  return false;
}

bool HopReceiver::mark(std::uint32_t link_sequence, bool& gap) {
  if (!started_) {
    started_ = true;
    highest_ = link_sequence;
    received_ = 1;
    return true;
  }
  const auto ahead = static_cast<std::int32_t>(link_sequence - highest_);
  if (ahead > 0) {
    gap = ahead > 1;
    received_ = ahead < 64 ? received_ << ahead | 1 : 1;
    highest_ = link_sequence;
    return true;
  }
  // The sender never has frames open farther back than an acknowledgment reaches, so this is an old repetition.
  if (ahead <= -64) return false;
  const std::uint64_t bit = std::uint64_t{1} << -ahead;
  const bool fresh = (received_ & bit) == 0;
  received_ |= bit;
  return fresh;
}

wire::HopAcknowledgment HopReceiver::acknowledge(Time now) {
  unacknowledged_ = 0;
  gap_since_.reset();
  due_ = Time::max();
  const auto nanoseconds = [](Time time) {
    return static_cast<std::uint32_t>(std::clamp<Time::rep>(time.count(), 0, 0xffffffff));
  };
  return {boot_, newest_counter_, nanoseconds(spacing_), nanoseconds(now - newest_arrival_), highest_, received_};
}

}  // namespace adhoc_communication::transport
