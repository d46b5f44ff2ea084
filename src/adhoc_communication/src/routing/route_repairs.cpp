// Local repair (RFC 3561 section 6.12): the robot where a route broke looks for a new one while the data waits there.
#include <algorithm>

#include "routing/router.hpp"

namespace adhoc_communication::routing {

/// Only near the destination, where one request of short reach finds it sooner than a new search by the source.
bool Router::start_repair(const Route& broken, const MacAddress& originator, Time now) {
  if (broken.hops > timings_.max_repair_ttl() || !broken.sequence_valid) return false;
  const Route* back = routes_.find(originator);
  const int half_way_back = back == nullptr ? 0 : back->hops / 2;
  const int hop_limit = std::max<int>(broken.hops, half_way_back) + timings_.local_add_ttl;
  if (!discovery_.repair(broken.destination, hop_limit, now)) return false;
  Repair& repair = repairs_[broken.destination];
  repair.precursors.insert(broken.precursors.begin(), broken.precursors.end());
  repair.former_hops = broken.hops;
  return true;
}

bool Router::repair_late(const MacAddress& destination, const MacAddress& originator, const MacAddress& previous_hop,
                         Time now) {
  const Route* broken = routes_.find(destination);
  if (broken == nullptr || broken->valid || !broken->repairable || !start_repair(*broken, originator, now))
    return false;
  repairs_[destination].precursors.insert(previous_hop);
  return true;
}

void Router::repair_succeeded(const MacAddress& destination, Repair repair, Time now) {
  const Route* route = routes_.usable(destination, now);
  repair.precursors.erase(route->next_hop);
  for (const MacAddress& precursor : repair.precursors) routes_.add_precursor(destination, precursor);
  if (route->hops <= repair.former_hops || repair.precursors.empty() || !error_limit_.take(now)) return;
  wire::RouteError error;
  error.no_delete = true;
  error.destinations.push_back({destination, route->sequence});
  send_error(error, repair.precursors, now);
}

void Router::announce_failed_repair(const MacAddress& destination, Time now) {
  const auto repair = repairs_.find(destination);
  if (repair == repairs_.end()) return;
  Route lost;
  lost.destination = destination;
  if (const Route* route = routes_.find(destination)) lost.sequence = route->sequence;
  lost.precursors = std::move(repair->second.precursors);
  repairs_.erase(repair);
  announce_broken({lost}, MacAddress{}, false, now);
}

/// The route became longer, but works. Whoever started it may look for a shorter one; here the next search does.
void Router::pass_on_repaired(const MacAddress& from, const wire::RouteError& error, Time now) {
  std::set<MacAddress> concerned;
  wire::RouteError passed;
  passed.no_delete = true;
  for (const wire::UnreachableDestination& destination : error.destinations) {
    const Route* route = routes_.usable(destination.address, now);
    if (route == nullptr || route->next_hop != from || route->precursors.empty()) continue;
    passed.destinations.push_back(destination);
    concerned.insert(route->precursors.begin(), route->precursors.end());
  }
  concerned.erase(from);
  if (!concerned.empty() && error_limit_.take(now)) send_error(passed, concerned, now);
}

std::vector<DiscoveryFailure> Router::take_failures(Time now) {
  std::vector<DiscoveryFailure> failures = discovery_.take_failures();
  for (const DiscoveryFailure& failure : failures) {
    if (failure.repair) announce_failed_repair(failure.target.address, now);
  }
  return failures;
}

}  // namespace adhoc_communication::routing
