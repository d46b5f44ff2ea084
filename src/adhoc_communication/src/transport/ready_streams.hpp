// Streams that have something to send and a neighbour to send it to, taking turns.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "round_robin.hpp"
#include "transport/priorities.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::transport {

/// Many streams go over few neighbours: which of these can take a frame is asked once, not for each stream.
template <typename Stream>
class ReadyStreams {
 public:
  /// Destination and priority.
  using Key = std::pair<std::string, std::uint8_t>;

  /// `over`: nothing if the stream is not ready.
  void set(const Key& key, Stream* stream, const std::optional<MacAddress>& over) {
    const auto known = all_.find(key);
    if (known == all_.end() ? !over : over == known->second.over) return;
    if (known != all_.end()) {
      auto& count = over_[key.second];
      const auto before = count.find(known->second.over);
      if (--before->second == 0) count.erase(before);
      all_.erase(known);
    }
    if (!over) return;
    all_.emplace(key, Entry{stream, *over});
    ++over_[key.second][*over];
  }
  /// The next one behind `last` of which `may_start` holds for its neighbour; null if there is none.
  template <typename Predicate>
  Stream* next(std::uint8_t priority, const Key& last, Predicate may_start) const {
    std::vector<MacAddress> open;
    for (const auto& [neighbor, count] : over_[priority]) {
      if (may_start(neighbor)) open.push_back(neighbor);
    }
    Stream* found = nullptr;
    if (open.empty()) return found;
    visit_after(all_, last, [&](const auto& item) {
      const auto& [key, entry] = item;
      if (key.second != priority || !std::binary_search(open.begin(), open.end(), entry.over)) return false;
      found = entry.stream;
      return true;
    });
    return found;
  }
  template <typename Predicate>
  bool any_over(Predicate holds) const {
    for (std::uint8_t priority = 0; priority < kPriorities; ++priority) {
      for (const auto& [neighbor, count] : over_[priority]) {
        if (holds(neighbor, priority)) return true;
      }
    }
    return false;
  }

 private:
  struct Entry {
    Stream* stream;
    MacAddress over;
  };
  std::map<Key, Entry> all_;
  std::array<std::map<MacAddress, std::size_t>, kPriorities> over_;  ///< how many streams of a priority, by neighbour
};

}  // namespace adhoc_communication::transport
