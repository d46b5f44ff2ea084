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
    seen_[key] = Seen{now + timings_.path_discovery_time(), 0, {}};
    found = seen_.find(key);
  }
  found->second.holders.insert(from);
  return fresh;
}

void RequestFlood::originate(const wire::RouteRequest& request, const MacAddress& self, Time now) {
  first_time(request, self, now);
  pending_.push_back({now, false, request});
}

void RequestFlood::forward(const wire::RouteRequest& request, Cost link, Time now) {
  const auto waiting = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& pending) {
    return !pending.broadcast_done && pending.request.originator == request.originator &&
           pending.request.id == request.id;
  });
  if (waiting != pending_.end()) {
    waiting->request = request;
    return;
  }
  const auto seen = seen_.find({request.originator, request.id});
  if (seen == seen_.end() || seen->second.forwards >= kMostForwards || pending_.size() >= kMostPending) return;
  ++seen->second.forwards;
  const Time penalty = kPenalty * (link - kPerfectHop) / kPerfectHop;
  pending_.push_back({now + random_.delay(kJitter) + std::min(penalty, kLongestPenalty), false, request});
}

void RequestFlood::poll(const Neighbors& neighbors, Time now) {
  for (std::size_t i = 0; i < pending_.size();) {
    Pending& pending = pending_[i];
    if (pending.due > now || (!pending.broadcast_done && outbox_.air_ready() > now)) {
      ++i;
    } else if (!pending.broadcast_done) {
      outbox_.broadcast(wire::FrameType::kRouteRequest, to_bytes(pending.request));
      pending.broadcast_done = true;
      pending.due = now + kConfirm + kWaitersPerHop * (now - pending.due);
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
    if (well_supplied(*neighbors.find(neighbor), seen->second, neighbors)) continue;
    outbox_.unicast(neighbor, wire::FrameType::kRouteRequest, to_bytes(request));
    ++copies;
  }
}

/// The neighbour hears enough of those who have broadcast the request as well.
bool RequestFlood::well_supplied(const Neighbor& neighbor, const Seen& seen, const Neighbors& neighbors) const {
  const auto reaches = [&](const MacAddress& address) {
    const Neighbor* holder = neighbors.find(address);
    return holder != nullptr && neighbor.hears.count(wire::neighbor_tag(holder->boot)) != 0;
  };
  return std::count_if(seen.holders.begin(), seen.holders.end(), reaches) >= kEnoughCopies;
}

Time RequestFlood::next_deadline() const {
  Time next = Time::max();
  for (const Pending& pending : pending_) {
    next = std::min(next, pending.broadcast_done ? pending.due : std::max(pending.due, outbox_.air_ready()));
  }
  return next;
}

}  // namespace adhoc_communication::routing
