#include "routing/router.hpp"

#include <algorithm>

namespace adhoc_communication::routing {

Router::Router(const Identity& self, const EngineOptions& options, const Timings& timings, Neighbors& neighbors,
               RobotDirectory& directory, Outbox& outbox, Random& random)
    : self_(self),
      timings_(timings),
      neighbors_(neighbors),
      directory_(directory),
      outbox_(outbox),
      routes_(timings),
      discovery_(timings, options),
      flood_(timings, outbox, random),
      error_limit_(timings.rate_limit) {}

void Router::search(const Target& target, Time now) {
  const Route* former = routes_.find(target.address);
  discovery_.search(target, former == nullptr ? 0 : former->hops, now);
}

void Router::on_hello(const MacAddress& from, wire::BootTag boot, std::uint32_t sequence, Time now) {
  routes_.heard_directly(from, boot, sequence, now + timings_.neighbor_timeout);
  finish_searches(now);
}

void Router::used(const MacAddress& source, const MacAddress& destination, const MacAddress& previous_hop, Time now) {
  const Time until = now + timings_.active_route_timeout;
  routes_.extend(source, until);
  routes_.extend(destination, until);
  if (const Route* route = routes_.find(destination)) routes_.extend(route->next_hop, until);
  routes_.extend(previous_hop, until);
  routes_.add_precursor(destination, previous_hop);
}

void Router::poll(Time now) {
  finish_searches(now);
  for (const RouteDiscovery::Step& step : discovery_.poll(now)) send_request(step, now);
  flood_.poll(neighbors_, now);
}

Time Router::next_deadline() const { return std::min(discovery_.next_deadline(), flood_.next_deadline()); }

void Router::finish_searches(Time now) {
  discovery_.finish_if([&](const Target& target) {
    if (target.address != MacAddress{}) return routes_.usable(target.address, now) != nullptr;
    const auto address = directory_.address_of(target.name);
    return address && routes_.usable(*address, now) != nullptr;
  });
}

}  // namespace adhoc_communication::routing
