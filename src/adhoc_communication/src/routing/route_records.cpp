// What hosts may write down of searches for routes.
#include "routing/router.hpp"

namespace adhoc_communication::routing {

RouteEnds Router::ends_to(const MacAddress& destination, Time now) const {
  const Route* route = routes_.usable(destination, now);
  return route == nullptr ? RouteEnds{{}, destination, 0} : RouteEnds{route->next_hop, destination, route->hops};
}

void Router::record_searches(Time now) {
  for (const RouteDiscovery::Ended& ended : discovery_.take_ended()) {
    if (!journal_.kept() || ended.requests == 0) continue;
    const auto named = directory_.address_of(ended.target.name);
    const MacAddress address =
        ended.target.address == MacAddress{} ? named.value_or(MacAddress{}) : ended.target.address;
    const Robot* robot = directory_.find(address);
    journal_.add(now, SearchEnded{ended.last_request, robot == nullptr ? ended.target.name : robot->name, ended.began,
                                  now, ended.requests, ended.replies, ends_to(address, now)});
  }
}

void Router::record_arrival(const wire::RouteRequest& request, const MacAddress& from, bool answered, Time now) {
  if (!journal_.kept()) return;
  journal_.add(now, RequestArrived{request.id, request.originator_name, flood_.copies(request), answered,
                                   RouteEnds{from, request.originator, request.hop_count}});
}

}  // namespace adhoc_communication::routing
