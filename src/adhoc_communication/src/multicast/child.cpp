#include "multicast/child.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication::multicast {

Child::Child(std::vector<std::uint16_t> sent_in, std::uint32_t coverage, Time patience, Time now)
    : sent_in_(std::move(sent_in)) {
  know_nothing();
  cover(coverage, patience, now);
}

void Child::know_nothing() {
  missing_.assign(sent_in_.size(), kUnknown);
  known_in_.assign(sent_in_.size(), 0);
}

void Child::cover(std::uint32_t coverage, Time patience, Time now) {
  coverage_ = coverage;
  done_ = false;
  progress_ = now;
  asked(patience, now);
}

bool Child::knows(std::size_t block) const {
  return missing_[block] == 0 || (missing_[block] != kUnknown && known_in_[block] >= sent_in_[block]);
}

void Child::asked(Time patience, Time now) {
  asked_ = now;
  question_wait_ = patience;
}

void Child::asked_by_itself(Time now) {
  const Time longest = misses_nothing() ? kLongestSubtreePatience : kSubtreePatience;
  asked(no_room_since_ ? kRoomRetry : std::min<Time>(2 * question_wait_, longest), now);
}

void Child::wait_for_room(Time now) {
  if (!no_room_since_) no_room_since_ = now;
  asked(kRoomRetry, now);
  know_nothing();
}

void Child::has_room(Time now) {
  if (std::exchange(no_room_since_, std::nullopt)) progress_ = now;
}

void Child::learn(const wire::GroupReport& report, Time now) {
  const std::size_t blocks = missing_.size();
  for (std::size_t block = 0; block < std::min<std::size_t>(report.first_block, blocks); ++block) {
    learn(block, 0, report.round, now);
  }
  for (std::size_t i = 0; i < report.missing.size() && report.first_block + i < blocks; ++i) {
    learn(report.first_block + i, report.missing[i], report.round, now);
  }
}

void Child::learn(std::size_t block, std::uint8_t missing, std::uint16_t round, Time now) {
  if (round < known_in_[block]) return;
  if (missing < missing_[block]) progress_ = now;
  missing_[block] = missing;
  known_in_[block] = round;
}

bool Child::misses_nothing() const {
  return std::all_of(missing_.begin(), missing_.end(), [](auto missing) { return missing == 0; });
}

bool Child::stuck(Time now) const {
  if (done_) return false;
  if (no_room_since_) return now - *no_room_since_ >= kRoomPatience;
  return now - progress_ >= (misses_nothing() ? kNoEnd : kNoProgress);
}

}  // namespace adhoc_communication::multicast
