#include "transport/hop_receiver.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

bool HopReceiver::take(std::uint32_t link_sequence, std::uint64_t counter, bool acknowledge_now, Time now) {
  bool in_order = false;
  const bool fresh = mark(link_sequence, in_order);
  newest_counter_ = std::max(newest_counter_, counter);
  ++unacknowledged_;
  const bool now_due = acknowledge_now || !fresh || !in_order || unacknowledged_ >= kFramesPerAcknowledgment;
  due_ = std::min(due_, now_due ? now : now + kLongestDelay);
  return fresh;
}

bool HopReceiver::mark(std::uint32_t link_sequence, bool& in_order) {
  if (!started_) {
    started_ = true;
    highest_ = link_sequence;
    received_ = 1;
    return true;
  }
  const auto ahead = static_cast<std::int32_t>(link_sequence - highest_);
  if (ahead > 0) {
    in_order = ahead == 1;
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

wire::HopAcknowledgment HopReceiver::acknowledge() {
  unacknowledged_ = 0;
  due_ = Time::max();
  return {boot_, newest_counter_, highest_, received_};
}

}  // namespace adhoc_communication::transport
