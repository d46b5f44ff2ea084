#include "transport/flood.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

bool FloodRelay::take(const wire::Flood& flood, Time now) {
  const Key key{flood.source, flood.source_boot, flood.id};
  const auto found = seen_.find(key);
  if (found != seen_.end() && now - found->second < kRemembered) return false;
  if (found == seen_.end() && seen_.size() >= kMostSeen) {
    seen_.erase(
        std::min_element(seen_.begin(), seen_.end(), [](const auto& a, const auto& b) { return a.second < b.second; }));
  }
  seen_[key] = now;
  if (flood.hop_limit > 1 && pending_.size() < kMostPending) {
    wire::Flood copy = flood;
    --copy.hop_limit;
    ++copy.hop_count;
    pending_.emplace_back(now + random_.delay(kJitter), std::move(copy));
  }
  return true;
}

void FloodRelay::poll(Time now) {
  for (std::size_t i = 0; i < pending_.size();) {
    if (pending_[i].first > now) {
      ++i;
      continue;
    }
    outbox_.broadcast(wire::FrameType::kFlood, to_bytes(pending_[i].second));
    pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

Time FloodRelay::next_deadline() const {
  Time next = Time::max();
  for (const auto& [due, flood] : pending_) next = std::min(next, due);
  return next;
}

}  // namespace adhoc_communication::transport
