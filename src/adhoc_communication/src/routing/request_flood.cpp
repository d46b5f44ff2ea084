#include "routing/request_flood.hpp"

#include <algorithm>

namespace adhoc_communication::routing {

bool RequestFlood::first_time(const wire::RouteRequest& request, const MacAddress& from, Time now) {
  const Key key{request.originator, request.id};
  auto found = seen_.find(key);
  const bool fresh = found == seen_.end() || found->second.forgotten <= now;
  if (fresh) {
    if (found == seen_.end() && seen_.size() >= kMostRequests) {
      seen_.erase(std::min_element(seen_.begin(), seen_.end(), [](const auto& a, const auto& b) {
        return a.second.forgotten < b.second.forgotten;
      }));
    }
    seen_[key] = Seen{now + std::max(timings_.path_discovery_time(), kShortestMemory), {}};
    found = seen_.find(key);
  }
  found->second.holders.insert(from);
  return fresh;
}

void RequestFlood::originate(const wire::RouteRequest& request, const MacAddress& self, Time now) {
  first_time(request, self, now);
  pending_.push_back({now, false, request});
}

void RequestFlood::forward(const wire::RouteRequest& request, double loss_of_arrival, Time now) {
  if (pending_.size() >= kMostPending) return;
  const Time penalty(static_cast<Time::rep>(loss_of_arrival * static_cast<double>(kLossPenalty.count())));
  pending_.push_back({now + random_.delay(kJitter) + penalty, false, request});
}

void RequestFlood::poll(const Neighbors& neighbors, Time now) {
  for (std::size_t i = 0; i < pending_.size();) {
    Pending& pending = pending_[i];
    if (pending.due > now) {
      ++i;
    } else if (!pending.broadcast_done) {
      outbox_.broadcast(wire::FrameType::kRouteRequest, to_bytes(pending.request));
      pending.broadcast_done = true;
      pending.due = now + kConfirm;
      ++i;
    } else {
      confirm(pending.request, neighbors, now);
      pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

void RequestFlood::confirm(const wire::RouteRequest& request, const Neighbors& neighbors, Time now) {
  const auto seen = seen_.find({request.originator, request.id});
  if (seen == seen_.end()) return;  // it had to make room
  const std::set<MacAddress>& holders = seen->second.holders;
  std::size_t copies = 0;
  for (const MacAddress& neighbor : neighbors.all_two_way(now)) {
    if (copies == kMostConfirmations) return;
    if (neighbor == request.originator || holders.count(neighbor) != 0) continue;
    outbox_.unicast(neighbor, wire::FrameType::kRouteRequest, to_bytes(request));
    ++copies;
  }
}

Time RequestFlood::next_deadline() const {
  Time next = Time::max();
  for (const Pending& pending : pending_) next = std::min(next, pending.due);
  return next;
}

}  // namespace adhoc_communication::routing
