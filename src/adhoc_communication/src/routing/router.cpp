#include "routing/router.hpp"

#include <algorithm>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::routing {

Router::Router(const Identity& self, const EngineOptions& options, Neighbors& neighbors, LivingRuns& runs,
               RobotDirectory& directory, Outbox& outbox, Random& random, Journal& journal, Time now)
    : self_(self),
      timings_(options.timings),
      neighbors_(neighbors),
      runs_(runs),
      directory_(directory),
      outbox_(outbox),
      journal_(journal),
      routes_(options.timings),
      discovery_(options, random),
      flood_(options.timings, options.num_link_retrans > 0, outbox, random),
      error_limit_(options.timings.error_rate_limit),
      hops_acknowledge_(options.num_link_retrans > 0),
      started_(now) {}

void Router::search(const Target& target, Time now) {
  routes_.keep(target.address, now);
  discovery_.search(target, last_hops(target), hops_told(target, now), now);
}

bool Router::search_for_others(const Target& target, Time now) {
  routes_.keep(target.address, now);
  return discovery_.search_for_others(target, last_hops(target), hops_told(target, now), now);
}

/// Length of the route there was; 0 if there was none.
std::uint8_t Router::last_hops(const Target& target) const {
  const Route* former = routes_.find(target.address);
  return former == nullptr ? std::uint8_t{0} : former->hops;
}

/// Length of the way to the target that life signs came; 0 if none is known, or it is not to be tried.
std::uint8_t Router::hops_told(const Target& target, Time now) const {
  if (!timings_.directed_requests) return 0;
  const MacAddress address = address_of(target);
  const Robot* robot = directory_.find(address);
  return robot != nullptr && way_told(address, now) ? robot->hops : 0;
}

/// All zero while it is not known.
MacAddress Router::address_of(const Target& target) const {
  return target.address != MacAddress{} ? target.address : directory_.address_of(target.name).value_or(MacAddress{});
}

/// The next hop of a request that is not flooded. A neighbour over whose lossy link goes no route is asked itself, as
/// long as no third robot is seen to be a way there.
std::optional<MacAddress> Router::way_told(const MacAddress& destination, Time now) const {
  if (const Route* route = routes_.usable(destination, now)) return route->next_hop;
  const auto teller = directory_.teller_of(destination);
  if (teller && neighbors_.two_way(*teller, now)) return teller;
  const bool itself =
      neighbors_.two_way(destination, now) && neighbors_.depends(destination, neighbors_.all_two_way(now), now);
  return itself ? std::optional(destination) : std::nullopt;
}

bool Router::search_nearby(const MacAddress& destination, Time now) {
  return discovery_.searching({destination, {}}) || discovery_.repair(destination, 1 + timings_.local_add_ttl, now);
}

void Router::on_hello(const MacAddress& from, std::uint32_t sequence, Time now) {
  hear_directly(from, sequence, now);
  finish_searches(now);
}

void Router::hear_directly(const MacAddress& neighbor, std::optional<std::uint32_t> sequence, Time now) {
  routes_.heard_directly(neighbor, neighbors_.find(neighbor)->boot, sequence, neighbors_.cost(neighbor),
                         now + neighbors_.patience(neighbor));
}

void Router::used(const MacAddress& source, const MacAddress& destination, const MacAddress& previous_hop, Time now) {
  const Time until = now + timings_.active_route_timeout;
  routes_.extend(source, until);
  routes_.extend(destination, until);
  if (const Route* route = routes_.find(destination)) {
    routes_.extend(route->next_hop, until);
    if (route->valid) look_for_better(*route, source == self_.address, now);
  }
  routes_.extend(previous_hop, until);
  routes_.add_precursor(destination, previous_hop);
}

/// A fading link is left before it breaks, and by the source a way for a shorter one, once that has cost as much as it
/// costs to ask: each robot passes the request on. The number that is asked for makes the answer news to all that rely
/// on the route, which carries data meanwhile.
void Router::look_for_better(const Route& route, bool is_source, Time now) {
  const Cost link = neighbors_.cost(route.next_hop);
  const ToldWay told = is_source ? told_way(route.destination, now) : ToldWay{};
  const std::uint32_t wasted = routes_.waste(route.destination, link, told);
  if (wasted == 0 || wasted < kPerfectHop * directory_.size()) return;
  const int hop_limit = route.hops + timings_.local_add_ttl;
  if (!discovery_.exchange(route.destination, route.sequence, hop_limit, now)) return;
  routes_.asked(route.destination, link, told);
}

ToldWay Router::told_way(const MacAddress& destination, Time now) const {
  const auto teller = directory_.teller_of(destination);
  if (!teller || !neighbors_.two_way(*teller, now)) return {};
  return {directory_.find(destination)->hops, now};
}

void Router::poll(Time now) {
  finish_searches(now);
  const auto told = [&](const Target& target) { return hops_told(target, now); };
  const auto present = [&](const Target& target) { return directory_.present(address_of(target)); };
  for (const RouteDiscovery::Step& step : discovery_.poll(told, now, present)) send_request(step, now);
  record_searches(now);
  flood_.poll(neighbors_, now);
  repeat_replies(now);
  send_waiting_errors(now);
}

Time Router::next_deadline() const {
  Time next = std::min(discovery_.next_deadline(), flood_.next_deadline());
  for (const auto& [neighbor, open] : open_replies_) next = std::min(next, open.due);
  if (!waiting_errors_.empty()) next = std::min(next, error_limit_.free_at(Time(0)));
  return next;
}

void Router::finish_searches(Time now) {
  discovery_.finish_if([&](const Target& target, const std::optional<std::uint32_t>& newer_than) {
    const Route* route = routes_.usable(address_of(target), now);
    return route != nullptr && (!newer_than || is_newer(route->sequence, *newer_than));
  });
  record_searches(now);
  for (auto iterator = repairs_.begin(); iterator != repairs_.end();) {
    if (routes_.usable(iterator->first, now) == nullptr) {
      ++iterator;
      continue;
    }
    repair_succeeded(iterator->first, std::move(iterator->second), now);
    iterator = repairs_.erase(iterator);
  }
}

}  // namespace adhoc_communication::routing
