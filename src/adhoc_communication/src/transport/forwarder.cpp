#include "transport/forwarder.hpp"

#include <algorithm>
#include <utility>

#include "transport/turn_taking.hpp"

namespace adhoc_communication::transport {

using wire::FrameType;

namespace {

struct Way {
  MacAddress source;
  MacAddress destination;
};

std::optional<Way> way_of(const HopFrame& frame) {
  if (frame.type == FrameType::kData) {
    if (const auto data = wire::read_data(wire::Reader(frame.body))) return Way{data->source, data->destination};
  }
  if (frame.type == FrameType::kTransportAcknowledgment) {
    if (const auto acknowledgment = wire::read_transport_acknowledgment(wire::Reader(frame.body))) {
      return Way{acknowledgment->source, acknowledgment->destination};
    }
  }
  return std::nullopt;
}

bool takes_turns(const wire::Data& data) { return TurnTaking::fills_turns(data); }
bool takes_turns(const wire::TransportAcknowledgment&) { return false; }

}  // namespace

void Forwarder::forward(const MacAddress& from, wire::Data data, Time now) {
  const std::uint8_t stream = data.stream;
  pass_on(from, std::move(data), FrameType::kData, stream, now);
}

void Forwarder::forward(const MacAddress& from, wire::TransportAcknowledgment acknowledgment, Time now) {
  pass_on(from, std::move(acknowledgment), FrameType::kTransportAcknowledgment, 0, now);
}

template <typename Message>
void Forwarder::pass_on(const MacAddress& from, Message message, FrameType type, std::uint8_t priority, Time now) {
  if (message.hops >= wire::kFarthestHop) return;
  const MacAddress destination = message.destination;
  const routing::Route* route = router_.route_to(destination, now);
  ++message.hops;
  if (route == nullptr &&
      (router_.repairing(destination) || router_.repair_late(destination, message.source, from, now))) {
    return held_.add(destination, {type, to_bytes(message), priority, from});
  }
  if (route == nullptr || route->next_hop == from) return router_.no_route_for(destination, from, now);
  HopFrame frame{type, to_bytes(message), priority, from};
  frame.beyond = hops_beyond(*route);
  if (takes_turns(message)) frame.route = static_cast<std::uint8_t>(std::min(message.hops + frame.beyond, 255));
  hops_.enqueue(route->next_hop, std::move(frame));
}

void Forwarder::link_lost(const MacAddress& neighbor, Time now) {
  std::vector<HopFrame> frames = hops_.take_all(neighbor);
  routing::DataInHand in_hand;
  bool reply_lost = false;
  for (const HopFrame& frame : frames) {
    reply_lost = reply_lost || frame.type == FrameType::kRouteReply;
    const std::optional<Way> way = way_of(frame);
    if (way && way->source != self_.address) in_hand[way->destination] = way->source;
  }
  if (reply_lost) router_.reply_lost(neighbor, now);
  router_.link_broken(neighbor, in_hand, now);
  for (HopFrame& frame : frames) {
    const std::optional<Way> way = way_of(frame);
    if (!way || way->source == self_.address || !router_.repairing(way->destination)) continue;
    // Once: frames longer than an interface takes would keep out those that their source sends in their place.
    if (!std::exchange(frame.held, true)) held_.add(way->destination, std::move(frame));
  }
}

/// A way back to the source is none: it has learned of the new route itself.
void Forwarder::release(Time now) {
  const auto decided = [this](const MacAddress& destination) { return !router_.repairing(destination); };
  for (auto& [destination, frames] : held_.take(decided)) {
    const routing::Route* route = router_.route_to(destination, now);
    for (HopFrame& frame : frames) {
      if (route != nullptr && way_of(frame)->source != route->next_hop) {
        frame.beyond = hops_beyond(*route);
        hops_.enqueue(route->next_hop, std::move(frame));
      }
    }
  }
}

}  // namespace adhoc_communication::transport
