// RREP: taking and passing on (RFC 3561 section 6.7).
#include "routing/router.hpp"

namespace adhoc_communication::routing {
namespace {

constexpr std::size_t kMostForwardedReplies = 256;
constexpr std::uint32_t kLongestLifetime_ms = 60'000;

}  // namespace

void Router::on_reply(const MacAddress& from, wire::RouteReply reply, Time now) {
  if (neighbors_.find(from) == nullptr) return;
  routes_.heard_directly(from, neighbors_.find(from)->boot, std::nullopt, now + timings_.neighbor_timeout);
  if (reply.destination == self_.address) return;  // no route to oneself
  if (directory_.is_former(reply.destination, reply.destination_boot)) return;
  // Runs have no order: an answer from somebody's old table must not displace a run that is known to live.
  const Robot* robot = directory_.find(reply.destination);
  const bool other_run = robot != nullptr && robot->announced && robot->boot != reply.destination_boot;
  if (other_run && reply.destination != from) return;
  ++reply.hop_count;
  const Time life = std::chrono::milliseconds(std::min(reply.lifetime_ms, kLongestLifetime_ms));
  const bool updated = routes_.update(
      {reply.destination, reply.destination_boot, reply.destination_sequence, reply.hop_count, from, now + life});
  if (updated)
    directory_.learn(reply.destination, reply.destination_name, reply.destination_boot, reply.hop_count, now);
  if (reply.originator == self_.address) return finish_searches(now);
  if (worth_forwarding(reply, updated, from, now)) forward_reply(std::move(reply), now);
}

/// Section 6.7: when the route was created or updated. A hello may have brought the same news before, so a reply that
/// agrees with the table is passed on as well, but only once.
bool Router::worth_forwarding(const wire::RouteReply& reply, bool updated, const MacAddress& from, Time now) {
  const Route* route = routes_.usable(reply.destination, now);
  if (route == nullptr || route->next_hop != from || route->sequence != reply.destination_sequence) return false;
  const auto key = std::pair(reply.originator, reply.destination);
  const auto last = forwarded_replies_.find(key);
  const bool repeated = last != forwarded_replies_.end() && last->second.sequence == reply.destination_sequence &&
                        now - last->second.at < timings_.path_discovery_time();
  if (repeated && !updated) return false;
  if (forwarded_replies_.size() >= kMostForwardedReplies) forwarded_replies_.clear();
  forwarded_replies_[key] = {reply.destination_sequence, now};
  return true;
}

void Router::forward_reply(wire::RouteReply reply, Time now) {
  const Route* back = routes_.usable(reply.originator, now);
  const Route* route = routes_.usable(reply.destination, now);
  if (back == nullptr || route == nullptr || back->next_hop == route->next_hop) return;
  const MacAddress towards_originator = back->next_hop;
  const MacAddress towards_destination = route->next_hop;
  routes_.add_precursor(reply.destination, towards_originator);
  routes_.add_precursor(towards_destination, towards_originator);
  routes_.add_precursor(reply.originator, towards_destination);
  routes_.extend(reply.originator, now + timings_.active_route_timeout);
  outbox_.unicast(towards_originator, wire::FrameType::kRouteReply, to_bytes(reply));
}

}  // namespace adhoc_communication::routing
