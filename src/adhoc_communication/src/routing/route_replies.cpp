// RREP: taking, passing on, and knowing that it arrived (RFC 3561 sections 6.7 and 6.8).
#include "routing/router.hpp"

namespace adhoc_communication::routing {
namespace {

constexpr std::size_t kMostForwardedReplies = 256;
constexpr int kMostReplyTries = 4;
constexpr std::uint32_t kLongestLifetime_ms = 60'000;

}  // namespace

void Router::on_reply(const MacAddress& from, wire::RouteReply reply, Time now) {
  if (neighbors_.find(from) == nullptr) return;
  hear_directly(from, std::nullopt, now);
  if (reply.acknowledgment_required) outbox_.unicast_once(from, wire::FrameType::kRouteReplyAcknowledgment, {}, now);
  if (reply.destination == self_.address) return;  // no route to oneself
  // Runs have no order: an answer from somebody's old table must not displace a run that is known to live.
  const Robot* robot = directory_.find(reply.destination);
  const bool known = robot != nullptr && robot->announced;
  if (known && !runs_.lives(reply.destination, reply.destination_boot)) return;
  if (!runs_.told(reply.destination, reply.destination_boot, now)) return;
  ++reply.hop_count;
  reply.cost = sum(reply.cost, neighbors_.cost(from));
  if (reply.originator == self_.address) discovery_.replied({reply.destination, reply.destination_name});
  if (reply.originator == self_.address && better_one_known(reply, now)) return;
  const Time life = std::chrono::milliseconds(std::min(reply.lifetime_ms, kLongestLifetime_ms));
  const bool updated = routes_.update({reply.destination, reply.destination_boot, reply.destination_sequence,
                                       reply.hop_count, reply.cost, from, now + life, neighbors_.cost(from)});
  if (updated)
    directory_.learn(reply.destination, reply.destination_name, reply.destination_boot, reply.hop_count, from, now);
  if (reply.originator == self_.address) return finish_searches(now);
  if (worth_forwarding(reply, updated, from, now)) forward_reply(std::move(reply), now);
}

/// The newest number wins, whatever the cost. But an own search may have found a much cheaper route just before, which
/// somebody answered for; not to take an offer never closes a loop.
bool Router::better_one_known(const wire::RouteReply& reply, Time now) const {
  const Route* route = routes_.usable(reply.destination, now);
  if (route == nullptr || route->boot != reply.destination_boot) return false;
  return 3 * cost_over(*route, neighbors_.cost(route->next_hop)) < 2 * reply.cost;
}

/// Section 6.7: when the route was created or updated. A hello may have brought the same news before, so a reply that
/// agrees with the table is passed on as well, but only once.
bool Router::worth_forwarding(const wire::RouteReply& reply, bool updated, const MacAddress& from, Time now) {
  const Route* route = routes_.usable(reply.destination, now);
  if (route == nullptr || route->next_hop != from || route->sequence != reply.destination_sequence) return false;
  const auto key = std::pair(reply.originator, reply.destination);
  const auto last = forwarded_replies_.find(key);
  const bool repeated = last != forwarded_replies_.end() && last->second.sequence == reply.destination_sequence &&
                        now - last->second.at < timings_.route_request_wait;
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
  send_reply(towards_originator, std::move(reply), now);
}

/// Where hops acknowledge every frame, the link itself tells when a reply is lost. Where they do not, RREP-ACK does.
void Router::send_reply(const MacAddress& to, wire::RouteReply reply, Time now) {
  reply.acknowledgment_required = !hops_acknowledge_;
  outbox_.unicast(to, wire::FrameType::kRouteReply, to_bytes(reply));
  if (!hops_acknowledge_) open_replies_[to] = {std::move(reply), now + timings_.next_hop_wait(), 1};
}

void Router::on_reply_acknowledgment(const MacAddress& from, Time now) {
  open_replies_.erase(from);
  neighbors_.acknowledged(from, now);
}

void Router::repeat_replies(Time now) {
  for (auto iterator = open_replies_.begin(); iterator != open_replies_.end();) {
    OpenReply& open = iterator->second;
    if (open.due > now) {
      ++iterator;
    } else if (open.tries < kMostReplyTries) {
      ++open.tries;
      open.due = now + timings_.next_hop_wait();
      outbox_.unicast(iterator->first, wire::FrameType::kRouteReply, to_bytes(open.reply));
    } else {
      reply_lost(iterator->first, now);
      iterator = open_replies_.erase(iterator);
    }
  }
}

}  // namespace adhoc_communication::routing
