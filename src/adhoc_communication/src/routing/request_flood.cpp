#include "routing/request_flood.hpp"

#include <algorithm>
#include <iterator>

namespace adhoc_communication::routing {

bool RequestFlood::first_time(const wire::RouteRequest& request, const MacAddress& from, Time now) {
  load_.heard(now);
  const Key identity = key(request);
  auto found = seen_.find(identity);
  const bool fresh = found == seen_.end() || found->second.forgotten <= now;
  if (fresh) {
    make_room(now);
    found = seen_.insert_or_assign(identity, Seen{now + timings_.path_discovery_time(), 0, {}}).first;
    order_.emplace_back(found->second.forgotten, identity);
  }
  found->second.holders.insert(from);
  return fresh;
}

/// All are remembered equally long, so the first to be forgotten is the first that came.
void RequestFlood::make_room(Time now) {
  while (!order_.empty() && (order_.front().first <= now || seen_.size() >= kMostRequests)) {
    seen_.erase(order_.front().second);
    order_.pop_front();
  }
}

void RequestFlood::originate(const wire::RouteRequest& request, const MacAddress& self, Time now) {
  first_time(request, self, now);
  pending_.push_back({now, false, request});
}

void RequestFlood::forward(const wire::RouteRequest& request, Cost link, Time now) {
  const auto waiting = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& pending) {
    return !pending.broadcast_done && key(pending.request) == key(request);
  });
  if (waiting != pending_.end()) {
    waiting->request = request;
    return;
  }
  const auto seen = seen_.find(key(request));
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
    } else if (!pending.broadcast_done && pass_on(pending.request, neighbors, now)) {
      pending.broadcast_done = true;
      pending.due = now + kConfirm + random_.delay(kConfirmJitter) + kWaitersPerHop * (now - pending.due);
      ++i;
    } else {
      if (pending.broadcast_done) confirm(pending.request, neighbors, now);
      pending_.erase(pending_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
}

/// True if it was broadcast, so that copies may have to follow.
bool RequestFlood::pass_on(const wire::RouteRequest& request, const Neighbors& neighbors, Time now) {
  const auto seen = seen_.find(key(request));
  if (seen != seen_.end() && load_.heavy(now)) {
    if (request.hop_count > 0 && seen->second.holders.size() >= kEnoughHolders) return false;
  } else if (seen != seen_.end()) {
    const std::vector<MacAddress> needy = in_need(request, seen->second, neighbors, now);
    // In a crowd others have broadcast it to all who need it.
    if (needy.empty() && request.hop_count > 0 && seen->second.holders.size() >= kFewestHolders) return false;
    if (const auto receiver = only_receiver(needy, neighbors, now)) {
      outbox_.unicast(*receiver, wire::FrameType::kRouteRequest, to_bytes(request));
      return false;
    }
  }
  outbox_.broadcast(wire::FrameType::kRouteRequest, to_bytes(request), now);
  return true;
}

void RequestFlood::confirm(const wire::RouteRequest& request, const Neighbors& neighbors, Time now) {
  const auto seen = seen_.find(key(request));
  if (seen == seen_.end()) return;  // it had to make room
  if (load_.heavy(now)) return;
  std::vector<MacAddress> needy = in_need(request, seen->second, neighbors, now);
  const Holders holders = holders_of(seen->second, neighbors);
  const std::vector<MacAddress> all = neighbors.all_two_way(now);
  const auto is_needless = [&](const MacAddress& neighbor) {
    return ends_at(request, neighbor) || silent_with_it(neighbor, holders, neighbors, now) ||
           neighbors.ways_round(neighbor, all, now) >= kEnoughWays;
  };
  needy.erase(std::remove_if(needy.begin(), needy.end(), is_needless), needy.end());
  const std::size_t copies = std::min(needy.size(), kMostConfirmations);
  for (std::size_t i = 0; i < copies; ++i) {
    outbox_.unicast(needy[i], wire::FrameType::kRouteRequest, to_bytes(request));
  }
}

/// The neighbour would not pass it on: nothing is lost if it did not get it, unless it may be the one asked for.
bool RequestFlood::ends_at(const wire::RouteRequest& request, const MacAddress& neighbor) {
  return request.hop_limit <= 1 && request.destination != MacAddress{} && request.destination != neighbor;
}

/// A neighbour that hears another holder, too, has the request from two, and may be silent because of that: where it
/// has hardly missed all of them, its silence is no sign of it.
bool RequestFlood::silent_with_it(const MacAddress& neighbor, const Holders& holders, const Neighbors& neighbors,
                                  Time now) {
  const double others = chance_to_miss(neighbor, holders, neighbors, now);
  return others < 1.0 && others * neighbors.beacon_loss(neighbor) <= kTolerableMiss;
}

/// The one neighbour that needs the request from this robot, if broadcasts to it are lost now and then.
std::optional<MacAddress> RequestFlood::only_receiver(const std::vector<MacAddress>& needy, const Neighbors& neighbors,
                                                      Time now) const {
  if (!hops_acknowledge_ || needy.size() != 1) return std::nullopt;
  if (neighbors.ways_round(needy.front(), neighbors.all_two_way(now), now) >= kEnoughWays) return std::nullopt;
  const double loss = std::max(neighbors.beacon_loss(needy.front()), neighbors.loss(needy.front()));
  return loss > kTolerableMiss ? std::optional(needy.front()) : std::nullopt;
}

/// The neighbours that need a copy from this robot: they neither have the request nor can count on others who do.
std::vector<MacAddress> RequestFlood::in_need(const wire::RouteRequest& request, const Seen& seen,
                                              const Neighbors& neighbors, Time now) {
  const std::vector<MacAddress> all = neighbors.all_two_way(now);
  const Holders holders = holders_of(seen, neighbors);
  std::vector<MacAddress> needy;
  std::copy_if(all.begin(), all.end(), std::back_inserter(needy), [&](const MacAddress& neighbor) {
    return neighbor != request.originator && seen.holders.count(neighbor) == 0 &&
           chance_to_miss(neighbor, holders, neighbors, now) > kTolerableMiss && neighbors.depends(neighbor, all, now);
  });
  return needy;
}

RequestFlood::Holders RequestFlood::holders_of(const Seen& seen, const Neighbors& neighbors) {
  Holders holders;
  for (const MacAddress& address : seen.holders) {
    if (const Neighbor* holder = neighbors.find(address)) holders.push_back(wire::neighbor_tag(holder->boot));
  }
  return holders;
}

/// Each of the copies that the holders have broadcast, as far as the neighbour has told how well it hears them; of a
/// chance that is tolerable, no more than that it is.
double RequestFlood::chance_to_miss(const MacAddress& neighbor, const Holders& holders, const Neighbors& neighbors,
                                    Time now) {
  const Neighbor* receiver = neighbors.find(neighbor);
  double chance = 1.0;
  for (const wire::NeighborTag holder : holders) {
    chance *= 1.0 - neighbors.delivery(*receiver, holder, now);
    if (chance <= kTolerableMiss) break;
  }
  return chance;
}

Time RequestFlood::next_deadline() const {
  Time next = Time::max();
  for (const Pending& pending : pending_) {
    next = std::min(next, pending.broadcast_done ? pending.due : std::max(pending.due, outbox_.air_ready()));
  }
  return next;
}

}  // namespace adhoc_communication::routing
