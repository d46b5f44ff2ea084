// Who is due when, so that nobody else has to be looked at.
#pragma once

#include <functional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

template <typename Who, typename Hash = std::hash<Who>>
class Deadlines {
 public:
  /// Time::max(): never.
  void set(const Who& who, Time when) {
    const auto known = times_.find(who);
    if (known != times_.end() ? known->second == when : when == Time::max()) return;
    erase(who);
    if (when == Time::max()) return;
    times_.emplace(who, when);
    queue_.emplace(when, who);
  }
  void erase(const Who& who) {
    const auto known = times_.find(who);
    if (known == times_.end()) return;
    queue_.erase({known->second, who});
    times_.erase(known);
  }
  Time next() const { return queue_.empty() ? Time::max() : queue_.begin()->first; }
  /// In the order of their deadlines; they stay until they are set anew.
  std::vector<Who> due(Time now) const {
    std::vector<Who> result;
    for (auto entry = queue_.begin(); entry != queue_.end() && entry->first <= now; ++entry) {
      result.push_back(entry->second);
    }
    return result;
  }
  std::size_t size() const { return times_.size(); }

 private:
  std::set<std::pair<Time, Who>> queue_;
  std::unordered_map<Who, Time, Hash> times_;
};

}  // namespace adhoc_communication
