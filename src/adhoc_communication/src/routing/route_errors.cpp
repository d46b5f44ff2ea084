// RERR: telling those who rely on a route that it is gone (RFC 3561 sections 6.11 and 6.12).
#include <algorithm>
#include <iterator>

#include "routing/router.hpp"

namespace adhoc_communication::routing {
namespace {

constexpr std::size_t kMostDestinations = 30;  ///< in one frame, so that it fits the smallest MTU allowed
constexpr std::size_t kMostUnicasts = 4;       ///< more precursors than this get one broadcast
constexpr std::size_t kMostWaiting = 64;       ///< errors; further ones are not announced

}  // namespace

void Router::link_broken(const MacAddress& neighbor, const DataInHand& in_hand, Time now) {
  neighbors_.link_failed(neighbor);
  std::vector<Route> lost;
  for (Route& route : routes_.break_link(neighbor, now)) {
    const auto data = in_hand.find(route.destination);
    if (data == in_hand.end() || !start_repair(route, data->second, now)) lost.push_back(std::move(route));
  }
  announce_broken(lost, neighbor, false, now);
}

void Router::on_error(const MacAddress& from, const wire::RouteError& error, Time now) {
  if (error.no_delete) return pass_on_repaired(from, error, now);
  announce_broken(routes_.break_destinations(error, from, now), from, error.unknown_sequence, now);
}

void Router::no_route_for(const MacAddress& destination, const MacAddress& previous_hop, Time now) {
  routes_.keep(destination, now);
  if (!waiting_errors_.empty() || !error_limit_.take(now)) return;
  const Route* former = routes_.find(destination);
  wire::RouteError error;
  error.unknown_sequence = former == nullptr || !former->sequence_valid;
  error.destinations.push_back({destination, error.unknown_sequence ? 0 : former->sequence});
  outbox_.unicast(previous_hop, wire::FrameType::kRouteError, to_bytes(error));
}

/// Only destinations that somebody asked for are announced, to those who asked.
void Router::announce_broken(const std::vector<Route>& broken, const MacAddress& except, bool unknown_sequence,
                             Time now) {
  std::set<MacAddress> concerned;
  std::vector<wire::UnreachableDestination> lost;
  for (const Route& route : broken) {
    std::set<MacAddress> precursors = route.precursors;
    precursors.erase(except);
    if (precursors.empty()) continue;
    lost.push_back({route.destination, route.sequence});
    concerned.insert(precursors.begin(), precursors.end());
  }
  for (std::size_t begin = 0; begin < lost.size() && waiting_errors_.size() < kMostWaiting;
       begin += kMostDestinations) {
    const std::size_t end = std::min(lost.size(), begin + kMostDestinations);
    wire::RouteError error;
    error.unknown_sequence = unknown_sequence;
    error.destinations.assign(lost.begin() + static_cast<std::ptrdiff_t>(begin),
                              lost.begin() + static_cast<std::ptrdiff_t>(end));
    waiting_errors_.push_back({std::move(error), concerned});
  }
  send_waiting_errors(now);
}

/// As many as the rate limit lets, without routes that have been found again meanwhile.
void Router::send_waiting_errors(Time now) {
  while (!waiting_errors_.empty()) {
    auto& [error, concerned] = waiting_errors_.front();
    auto& lost = error.destinations;
    lost.erase(std::remove_if(lost.begin(), lost.end(),
                              [&](const auto& destination) { return routes_.usable(destination.address, now); }),
               lost.end());
    if (!lost.empty()) {
      if (!error_limit_.take(now)) return;
      send_error(error, concerned, now);
    }
    waiting_errors_.pop_front();
  }
}

/// A silent neighbour has most likely driven away; should it send data all the same, it is told then.
void Router::send_error(const wire::RouteError& error, std::set<MacAddress> concerned, Time now) {
  for (auto precursor = concerned.begin(); precursor != concerned.end();) {
    precursor = neighbors_.silent(*precursor, now) ? concerned.erase(precursor) : std::next(precursor);
  }
  if (concerned.size() > kMostUnicasts) return outbox_.broadcast(wire::FrameType::kRouteError, to_bytes(error), now);
  for (const MacAddress& precursor : concerned) {
    outbox_.unicast(precursor, wire::FrameType::kRouteError, to_bytes(error));
  }
}

}  // namespace adhoc_communication::routing
