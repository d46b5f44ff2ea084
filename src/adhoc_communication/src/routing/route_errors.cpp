// RERR: telling those who rely on a route that it is gone (RFC 3561 section 6.11).
#include "routing/router.hpp"

namespace adhoc_communication::routing {
namespace {

constexpr std::size_t kMostDestinations = 30;  ///< in one frame, so that it fits the smallest MTU allowed
constexpr std::size_t kMostUnicasts = 4;       ///< more precursors than this get one broadcast

}  // namespace

void Router::link_broken(const MacAddress& neighbor, Time now) {
  neighbors_.link_failed(neighbor);
  announce_broken(routes_.break_link(neighbor, now), neighbor, false, now);
}

void Router::on_error(const MacAddress& from, const wire::RouteError& error, Time now) {
  announce_broken(routes_.break_destinations(error, from, now), from, error.unknown_sequence, now);
}

void Router::no_route_for(const MacAddress& destination, const MacAddress& previous_hop, Time now) {
  if (!error_limit_.take(now)) return;
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
  for (std::size_t begin = 0; begin < lost.size(); begin += kMostDestinations) {
    if (!error_limit_.take(now)) return;
    const std::size_t end = std::min(lost.size(), begin + kMostDestinations);
    wire::RouteError error;
    error.unknown_sequence = unknown_sequence;
    error.destinations.assign(lost.begin() + static_cast<std::ptrdiff_t>(begin),
                              lost.begin() + static_cast<std::ptrdiff_t>(end));
    if (concerned.size() > kMostUnicasts) {
      outbox_.broadcast(wire::FrameType::kRouteError, to_bytes(error));
      continue;
    }
    for (const MacAddress& precursor : concerned) {
      outbox_.unicast(precursor, wire::FrameType::kRouteError, to_bytes(error));
    }
  }
}

}  // namespace adhoc_communication::routing
