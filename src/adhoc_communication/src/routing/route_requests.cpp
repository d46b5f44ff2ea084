// RREQ: originating, answering, passing on (RFC 3561 sections 6.3, 6.5, 6.6).
#include <algorithm>

#include "routing/router.hpp"
#include "routing/sequence_number.hpp"

namespace adhoc_communication::routing {

void Router::send_request(const RouteDiscovery::Step& step, Time now) {
  wire::RouteRequest request;
  request.gratuitous = true;  // packets are acknowledged end to end, so the destination needs the way back
  // Others may still have routes by way of a former run of this robot, which must not come back as answers. So for the
  // time of section 6.13 only the destination answers, with a new number.
  request.destination_only = timings_.destination_only || now - started_ < timings_.delete_period;
  request.hop_limit = step.hop_limit;
  request.id = next_request_id_++;
  request.destination = step.target.address;
  request.destination_name = step.target.name;
  const Route* former = routes_.find(step.target.address);
  request.unknown_sequence_number = former == nullptr || !former->sequence_valid;
  if (!request.unknown_sequence_number) request.destination_sequence = former->sequence + (step.newer_than ? 1 : 0);
  request.originator = self_.address;
  request.originator_sequence = ++own_sequence_;  // section 6.1: immediately before a discovery
  request.originator_boot = self_.boot;
  request.originator_name = self_.name;
  discovery_.requested(step.target, request.id);
  const auto way = step.directed ? way_told(address_asked(request), now) : std::nullopt;
  if (!way) return flood_.originate(request, self_.address, now);
  request.directed = true;
  outbox_.unicast(*way, wire::FrameType::kRouteRequest, to_bytes(request));
}

void Router::on_request(const MacAddress& from, wire::RouteRequest request, Time now) {
  // Section 6.8: a neighbour that does not hear this robot cannot carry the reply.
  if (!neighbors_.two_way(from, now)) return;
  hear_directly(from, std::nullopt, now);
  // Making routes of own requests can give loops (van Glabbeek et al., MSWiM 2013).
  if (request.originator == self_.address) return;
  if (!runs_.told(request.originator, request.originator_boot, now)) return;
  const bool first = flood_.first_time(request, from, now);
  ++request.hop_count;
  request.cost = sum(request.cost, neighbors_.cost(from));
  const Time reverse_life = 2 * timings_.net_traversal_time() - 2 * request.hop_count * timings_.node_traversal_time;
  const bool better =
      routes_.update({request.originator, request.originator_boot, request.originator_sequence, request.hop_count,
                      request.cost, from, now + reverse_life, neighbors_.cost(from)});
  // A later copy counts only if it came a cheaper way.
  if (is_destination(request)) record_arrival(request, from, first || better, now);
  if (!first && !better) return;
  directory_.learn(request.originator, request.originator_name, request.originator_boot, request.hop_count, from, now);
  if (is_destination(request)) return answer_as_destination(request, from, first, now);
  if (!answer_from_table(request, from, now)) forward_request(std::move(request), from, now);
}

bool Router::is_destination(const wire::RouteRequest& request) const {
  if (request.destination != MacAddress{}) return request.destination == self_.address;
  return request.destination_name == self_.name;
}

MacAddress Router::address_asked(const wire::RouteRequest& request) const {
  if (request.destination != MacAddress{}) return request.destination;
  return directory_.address_of(request.destination_name).value_or(MacAddress{});
}

void Router::answer_as_destination(const wire::RouteRequest& request, const MacAddress& to, bool first, Time now) {
  // Sections 6.1 and 6.6.1: at least the number asked for.
  if (!request.unknown_sequence_number) own_sequence_ = newest(own_sequence_, request.destination_sequence);
  if (first && request.destination_only) ++own_sequence_;
  wire::RouteReply reply;
  reply.destination = self_.address;
  reply.destination_sequence = own_sequence_;
  reply.destination_boot = self_.boot;
  reply.destination_name = self_.name;
  reply.originator = request.originator;
  reply.lifetime_ms = static_cast<std::uint32_t>(timings_.my_route_timeout() / std::chrono::milliseconds(1));
  routes_.extend(request.originator, now + timings_.active_route_timeout);
  send_reply(to, std::move(reply), now);
}

/// Section 6.6.2.
bool Router::answer_from_table(const wire::RouteRequest& request, const MacAddress& to, Time now) {
  if (request.destination_only) return false;
  const Route* route = routes_.usable(address_asked(request), now);
  if (route == nullptr || !route->sequence_valid || route->next_hop == to) return false;
  if (!request.unknown_sequence_number && is_newer(request.destination_sequence, route->sequence)) return false;
  const Robot* robot = directory_.find(route->destination);
  if (robot == nullptr || robot->boot != route->boot) return false;  // a route to a former run is no news

  wire::RouteReply reply;
  reply.hop_count = route->hops;
  reply.cost = route->cost;
  reply.destination = route->destination;
  reply.destination_sequence = route->sequence;
  reply.destination_boot = route->boot;
  reply.destination_name = robot->name;
  reply.originator = request.originator;
  reply.lifetime_ms = static_cast<std::uint32_t>((route->expires - now) / std::chrono::milliseconds(1));
  routes_.add_precursor(route->destination, to);
  routes_.add_precursor(request.originator, route->next_hop);
  routes_.extend(request.originator, now + timings_.active_route_timeout);
  send_reply(to, std::move(reply), now);
  if (request.gratuitous) answer_gratuitously(request, *route, now);
  return true;
}

/// Section 6.6.3: the destination learns of the way back although the request never reaches it.
void Router::answer_gratuitously(const wire::RouteRequest& request, const Route& to_destination, Time now) {
  const Route* back = routes_.usable(request.originator, now);
  if (back == nullptr) return;
  wire::RouteReply reply;
  reply.hop_count = back->hops;
  reply.cost = back->cost;
  reply.destination = request.originator;
  reply.destination_sequence = request.originator_sequence;
  reply.destination_boot = request.originator_boot;
  reply.destination_name = request.originator_name;
  reply.originator = to_destination.destination;
  reply.lifetime_ms = static_cast<std::uint32_t>((back->expires - now) / std::chrono::milliseconds(1));
  send_reply(to_destination.next_hop, std::move(reply), now);
}

void Router::forward_request(wire::RouteRequest request, const MacAddress& from, Time now) {
  if (request.hop_limit <= 1 || request.hop_count >= timings_.net_diameter) return;
  if (journal_.kept()) journal_.add(now, RequestPassedOn{request.id, request.originator_name, from});
  --request.hop_limit;
  // Section 6.5: the copy asks for the newest number known, but the asked one is not believed here.
  if (const Route* known = routes_.find(address_asked(request)); known != nullptr && known->sequence_valid) {
    request.destination_sequence =
        request.unknown_sequence_number ? known->sequence : newest(request.destination_sequence, known->sequence);
    request.unknown_sequence_number = false;
  }
  if (!request.directed) {
    // The copy over clean links is to win the race, if there can be another one.
    const bool race = neighbors_.bypassed(from, wire::neighbor_tag(self_.boot), now);
    return flood_.forward(request, race ? neighbors_.cost(from) : kPerfectHop, now);
  }
  // Where the way ends the originator hears nothing, and floods.
  const auto way = way_told(address_asked(request), now);
  if (way && *way != from) outbox_.unicast(*way, wire::FrameType::kRouteRequest, to_bytes(request));
}

}  // namespace adhoc_communication::routing
