#include "transport/flood.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

bool FloodRelay::take(const wire::Flood& flood, Time now) {
  const Key key{flood.source, flood.source_boot, flood.id};
  if (seen_.count(key) != 0) return false;
  if (seen_.size() >= kMostSeen) {
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

bool FloodRelay::originate(SendId id, Bytes body) {
  if (waiting_.size() >= kMostWaiting) return false;
  waiting_.emplace_back(id, std::move(body));
  return true;
}

std::vector<SendId> FloodRelay::take_waiting() {
  std::vector<SendId> ids;
  for (const auto& [id, body] : std::exchange(waiting_, {})) ids.push_back(id);
  return ids;
}

void FloodRelay::poll(Time now) {
  while (!waiting_.empty() && outbox_.air_ready() <= now) {
    outbox_.broadcast(wire::FrameType::kFlood, std::move(waiting_.front().second), now);
    sent_.push_back(waiting_.front().first);
    waiting_.pop_front();
  }
  for (std::size_t i = 0; i < pending_.size();) {
    if (pending_[i].first > now) {
      ++i;
      continue;
    }
    outbox_.broadcast(wire::FrameType::kFlood, to_bytes(pending_[i].second), now);
    pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

Time FloodRelay::next_deadline() const {
  Time next = waiting_.empty() ? Time::max() : outbox_.air_ready();
  for (const auto& [due, flood] : pending_) next = std::min(next, due);
  return next;
}

}  // namespace adhoc_communication::transport
