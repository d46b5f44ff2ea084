#include "routing/route_table.hpp"

#include <algorithm>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::routing {

namespace {

constexpr Cost kHealthy = 3 * kPerfectHop / 2;  ///< of a link: it has recovered
constexpr int kToldHop = 5 * kPerfectHop / 4;   ///< what a hop of a way that is told of costs, for all that is known
constexpr Time kToldAgain = std::chrono::seconds(30);  ///< after which a way that was not found is looked for again

/// What a frame would save on a shorter way that is told of.
std::uint32_t saved_on(const ToldWay& told, const Route& route, Cost link) {
  const ToldWay& before = route.asked_for;
  const bool in_vain = before.hops != 0 && told.hops >= before.hops && told.at < before.at + kToldAgain;
  if (told.hops == 0 || told.hops >= route.hops || in_vain) return 0;
  return static_cast<std::uint32_t>(std::max(0, cost_over(route, link) - kToldHop * told.hops));
}

/// What it might save on a way round the link.
std::uint32_t saved_round(Cost link, const Route& route) {
  const bool grown = 2 * link >= 3 * std::max(route.link, route.asked);
  return grown && !is_unbeatable(link) ? std::uint32_t{link} - kCheapestDetour : 0;
}

void begin_anew(Route& route) {
  route.asked = 0;
  route.asked_for = {};
}

}  // namespace

const Route* RouteTable::find(const MacAddress& destination) const {
  const auto found = routes_.find(destination);
  return found == routes_.end() ? nullptr : &found->second;
}

const Route* RouteTable::usable(const MacAddress& destination, Time now) const {
  const Route* route = find(destination);
  return route != nullptr && route->valid && route->expires > now ? route : nullptr;
}

bool RouteTable::update(const RouteOffer& offer) {
  Route& route = entry(offer.destination);
  // Another run of the destination counts from its own start: its numbers cannot be compared with the stored one.
  const bool other_run = offer.boot != 0 && route.boot != 0 && offer.boot != route.boot;
  const bool known = route.sequence_valid && !other_run;
  if (known && offer.sequence) {
    if (is_newer(route.sequence, *offer.sequence)) return false;
    const bool as_new = *offer.sequence == route.sequence;
    if (as_new && route.valid && offer.cost >= route.cost) {
      if (route.next_hop == offer.next_hop) route.expires = std::max(route.expires, offer.expires);
      return false;
    }
  }
  if (known && !offer.sequence && route.valid) return false;
  if (offer.boot != 0) route.boot = offer.boot;
  if (offer.sequence) route.sequence = *offer.sequence;
  route.sequence_valid = offer.sequence.has_value() || known;
  route.hops = offer.hops;
  route.cost = offer.cost;
  route.link = offer.link;
  if (route.next_hop != offer.next_hop) begin_anew(route);
  route.wasted = 0;
  route.next_hop = offer.next_hop;
  route.expires = route.valid ? std::max(route.expires, offer.expires) : offer.expires;
  route.valid = true;
  changed_.insert(offer.destination);
  return true;
}

void RouteTable::heard_directly(const MacAddress& neighbor, wire::BootTag boot, std::optional<std::uint32_t> sequence,
                                Cost cost, Time expires) {
  const Route* known = find(neighbor);
  const bool other_run = known != nullptr && known->boot != 0 && boot != known->boot;
  const bool usable = known != nullptr && known->valid && !other_run;
  const bool direct = usable && known->next_hop == neighbor;
  if (!direct && !is_fair(cost) && (!usable || known->cost <= cost)) return;
  Route& route = entry(neighbor);
  if (other_run) route.sequence_valid = false;
  route.boot = boot;
  const bool as_new = route.sequence_valid && (!sequence || !is_newer(*sequence, route.sequence));
  if (sequence) {
    route.sequence = as_new ? route.sequence : *sequence;
    route.sequence_valid = true;
  }
  if (!direct) {
    begin_anew(route);
    route.wasted = 0;
  }
  route.cost = direct && as_new ? std::min(route.cost, cost) : cost;
  route.link = route.cost;
  route.expires = route.valid ? std::max(route.expires, expires) : expires;
  route.hops = 1;
  if (!route.valid || route.next_hop != neighbor) changed_.insert(neighbor);
  route.next_hop = neighbor;
  route.valid = true;
}

void RouteTable::extend(const MacAddress& destination, Time until) {
  const auto found = routes_.find(destination);
  if (found != routes_.end() && found->second.valid) found->second.expires = std::max(found->second.expires, until);
}

void RouteTable::keep(const MacAddress& destination, Time now) {
  const auto found = routes_.find(destination);
  if (found != routes_.end() && !found->second.valid) found->second.expires = now + timings_.delete_period;
}

void RouteTable::add_precursor(const MacAddress& destination, const MacAddress& precursor) {
  const auto found = routes_.find(destination);
  if (found == routes_.end() || found->second.precursors.size() >= kMostPrecursors) return;
  found->second.precursors.insert(precursor);
}

std::uint32_t RouteTable::waste(const MacAddress& destination, Cost link, const ToldWay& told) {
  const auto found = routes_.find(destination);
  if (found == routes_.end()) return 0;
  Route& route = found->second;
  if (link <= kHealthy) route.asked = 0;
  const std::uint32_t wasted = std::max(saved_round(link, route), saved_on(told, route, link));
  if (wasted == 0 || !route.sequence_valid) return 0;
  route.wasted += wasted;
  return route.wasted;
}

void RouteTable::asked(const MacAddress& destination, Cost link, const ToldWay& told) {
  const auto found = routes_.find(destination);
  if (found == routes_.end()) return;
  found->second.asked = link;
  found->second.asked_for = told;
  found->second.wasted = 0;
}

std::vector<Route> RouteTable::break_link(const MacAddress& next_hop, Time now) {
  std::vector<Route> broken;
  for (auto& [destination, route] : routes_) {
    if (!route.valid || route.next_hop != next_hop) continue;
    if (route.sequence_valid) ++route.sequence;
    invalidate(route, now);
    route.repairable = true;
    broken.push_back(route);
    route.precursors.clear();
  }
  return broken;
}

std::vector<Route> RouteTable::break_destinations(const wire::RouteError& error, const MacAddress& from, Time now) {
  std::vector<Route> broken;
  for (const wire::UnreachableDestination& lost : error.destinations) {
    const auto found = routes_.find(lost.address);
    if (found == routes_.end()) continue;
    Route& route = found->second;
    if (!route.valid || route.next_hop != from || route.destination == from) continue;
    if (error.unknown_sequence) {
      if (route.sequence_valid) ++route.sequence;
    } else {
      if (route.sequence_valid && is_newer(route.sequence, lost.sequence)) continue;
      // Others may rely on this entry with its number, so it must not come back with the same one and a greater cost.
      const bool same = route.sequence_valid && route.sequence == lost.sequence;
      route.sequence = lost.sequence + (same ? 1 : 0);
      route.sequence_valid = true;
    }
    invalidate(route, now);
    broken.push_back(route);
    route.precursors.clear();
  }
  return broken;
}

void RouteTable::expire(Time now) {
  for (auto iterator = routes_.begin(); iterator != routes_.end();) {
    Route& route = iterator->second;
    if (route.expires > now) {
      ++iterator;
    } else if (route.valid) {
      if (route.sequence_valid) ++route.sequence;
      invalidate(route, now);
      ++iterator;
    } else {
      iterator = routes_.erase(iterator);
    }
  }
}

Route& RouteTable::entry(const MacAddress& destination) {
  const auto found = routes_.find(destination);
  if (found != routes_.end()) return found->second;
  if (routes_.size() >= kMostRoutes) {
    const auto first = std::min_element(routes_.begin(), routes_.end(), [](const auto& a, const auto& b) {
      return a.second.expires < b.second.expires;
    });
    changed_.insert(first->first);
    routes_.erase(first);
  }
  Route& route = routes_[destination];
  route.destination = destination;
  return route;
}

void RouteTable::invalidate(Route& route, Time now) {
  changed_.insert(route.destination);
  route.valid = false;
  route.repairable = false;
  route.expires = now + timings_.delete_period;
}

}  // namespace adhoc_communication::routing
