// Who goes next where several kinds of traffic wait.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace adhoc_communication::transport {

/// Whoever has sent the fewest octets goes first (deficit round robin). Who had nothing to send is not owed more than
/// kMostCredit for that.
class FairShare {
 public:
  enum Kind : std::size_t { kTransit, kGroups, kOwn, kKinds };
  static constexpr std::size_t kMostCredit = 3000;

  std::array<Kind, kKinds> order() const {
    std::array<Kind, kKinds> kinds{kTransit, kGroups, kOwn};
    std::stable_sort(kinds.begin(), kinds.end(), [this](Kind a, Kind b) { return sent_[a] < sent_[b]; });
    return kinds;
  }
  void charge(Kind kind, std::size_t octets) {
    sent_[kind] += octets;
    const std::size_t most = *std::max_element(sent_.begin(), sent_.end());
    for (std::size_t& sent : sent_) sent = std::max(sent + kMostCredit, most) - kMostCredit;
    const std::size_t least = *std::min_element(sent_.begin(), sent_.end());
    for (std::size_t& sent : sent_) sent -= least;
  }

 private:
  std::array<std::size_t, kKinds> sent_{};
};

}  // namespace adhoc_communication::transport
