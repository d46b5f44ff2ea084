// Which frame counters of one run of a sender have been taken already (the scheme of RFC 4303 section 3.4.3).
#pragma once

#include <array>
#include <cstdint>

namespace adhoc_communication::security {

/// Counters up to kSpan behind the newest one are told apart; older ones count as seen.
class ReplayWindow {
 public:
  static constexpr std::uint64_t kSpan = 1024;

  bool seen(std::uint64_t counter) const {
    if (counter <= oldest_) return true;
    if (counter > newest_) return false;
    return newest_ - counter >= kSpan || (words_[word(counter)] >> counter % 64 & 1) != 0;
  }
  /// Only for the counter of a frame that has proved genuine.
  void take(std::uint64_t counter) {
    if (counter > newest_) {
      const std::uint64_t fresh = counter - newest_;
      if (fresh >= kSpan) {
        words_.fill(0);
      } else {
        for (std::uint64_t skipped = newest_ + 1; skipped < counter; ++skipped) clear(skipped);
      }
      newest_ = counter;
    }
    words_[word(counter)] |= std::uint64_t{1} << counter % 64;
  }
  /// From now on, only greater ones than this are new.
  void begin_behind(std::uint64_t counter) { oldest_ = counter; }
  std::uint64_t newest() const { return newest_; }

 private:
  static std::size_t word(std::uint64_t counter) { return counter / 64 % (kSpan / 64); }
  void clear(std::uint64_t counter) { words_[word(counter)] &= ~(std::uint64_t{1} << counter % 64); }

  std::uint64_t oldest_ = 0;
  std::uint64_t newest_ = 0;
  std::array<std::uint64_t, kSpan / 64> words_{};
};

}  // namespace adhoc_communication::security
