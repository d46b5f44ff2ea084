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

bool FloodRelay::originate(SendId id, Bytes body, Time lifetime, Time now) {
  if (waiting_.size() >= kMostWaiting) return false;
  waiting_.push_back({id, std::move(body), lifetime, lifetime > Time(0) ? now + lifetime : Time::max()});
  return true;
}

std::vector<SendId> FloodRelay::take_waiting() {
  std::vector<SendId> ids;
  for (const Waiting& flood : std::exchange(waiting_, {})) ids.push_back(flood.id);
  return ids;
}

void FloodRelay::drop_overdue(Time now) {
  const auto overdue = std::stable_partition(waiting_.begin(), waiting_.end(),
                                             [now](const Waiting& flood) { return flood.until > now; });
  std::for_each(overdue, waiting_.end(),
                [this](const Waiting& flood) { overdue_.emplace_back(flood.id, flood.lifetime); });
  waiting_.erase(overdue, waiting_.end());
}

void FloodRelay::poll(Time now) {
  drop_overdue(now);
  while (!waiting_.empty() && outbox_.air_ready() <= now) {
    outbox_.broadcast(wire::FrameType::kFlood, std::move(waiting_.front().body), now);
    sent_.push_back(waiting_.front().id);
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
  for (const Waiting& flood : waiting_) next = std::min(next, flood.until);
  for (const auto& [due, flood] : pending_) next = std::min(next, due);
  return next;
}

}  // namespace adhoc_communication::transport
