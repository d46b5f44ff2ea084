// Who goes next where several wait.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace adhoc_communication::air {

/// Whoever has sent the fewest octets goes first (deficit round robin). Who had nothing to send is not owed more than
/// kMostCredit for that, so nobody is remembered for long.
template <typename Who>
class FairShare {
 public:
  static constexpr std::uint64_t kMostCredit = 3000;
  static constexpr std::size_t kMostRemembered = 256;  ///< as many as there can be neighbours

  void sort(std::vector<Who>& waiting) const {
    if (waiting.size() < 2) return;
    std::stable_sort(waiting.begin(), waiting.end(), [this](const Who& a, const Who& b) { return sent(a) < sent(b); });
  }
  void charge(const Who& who, std::size_t octets) {
    const std::uint64_t before = sent(who);
    turn_ = std::max(turn_, before);
    sent_[who] = before + octets;
    for (auto entry = sent_.begin(); entry != sent_.end();) {
      entry = entry->second <= least() ? sent_.erase(entry) : std::next(entry);
    }
    if (sent_.size() <= kMostRemembered) return;
    sent_.erase(
        std::min_element(sent_.begin(), sent_.end(), [](const auto& a, const auto& b) { return a.second < b.second; }));
  }
  std::size_t remembered() const { return sent_.size(); }

 private:
  std::uint64_t least() const { return turn_ - std::min(turn_, kMostCredit); }
  std::uint64_t sent(const Who& who) const {
    const auto found = sent_.find(who);
    return found == sent_.end() ? least() : std::max(found->second, least());
  }

  std::map<Who, std::uint64_t> sent_;
  std::uint64_t turn_ = 0;  ///< what the one that went last had sent before
};

}  // namespace adhoc_communication::air
