// What was under way over a link that is lost: it waits for the repair of its route, or is left to the end-to-end
// repetition.
#include "engine_implementation.hpp"

namespace adhoc_communication {
namespace {

struct Way {
  MacAddress source;
  MacAddress destination;
};

/// Of a frame that travels further than to the next robot.
std::optional<Way> way_of(const transport::HopFrame& frame) {
  if (frame.type == wire::FrameType::kData) {
    if (const auto data = wire::read_data(wire::Reader(frame.body))) return Way{data->source, data->destination};
  }
  if (frame.type == wire::FrameType::kTransportAcknowledgment) {
    if (const auto acknowledgment = wire::read_transport_acknowledgment(wire::Reader(frame.body))) {
      return Way{acknowledgment->source, acknowledgment->destination};
    }
  }
  return std::nullopt;
}

}  // namespace

/// Frames to the neighbour go unanswered, it fell silent, or it has restarted.
void Engine::Implementation::link_lost(const MacAddress& neighbor, Time now) {
  std::vector<transport::HopFrame> frames = hops_.take_all(neighbor);
  routing::DataInHand in_hand;
  bool reply_lost = false;
  for (const transport::HopFrame& frame : frames) {
    reply_lost = reply_lost || frame.type == wire::FrameType::kRouteReply;
    const std::optional<Way> way = way_of(frame);
    if (way && way->source != self_.address) in_hand[way->destination] = way->source;
  }
  if (reply_lost) router_.reply_lost(neighbor, now);
  router_.link_broken(neighbor, in_hand, now);
  for (transport::HopFrame& frame : frames) {
    const std::optional<Way> way = way_of(frame);
    if (way && way->source != self_.address && router_.repairing(way->destination)) {
      // Once: frames longer than an interface takes would keep out those that their source sends in their place.
      if (std::exchange(frame.held, true)) continue;
      held_.add(way->destination, std::move(frame));
    }
  }
  distributor_.link_lost(neighbor, now);
}

/// The repair has succeeded or failed. A way back to the source is none: it has learned of the new route itself.
void Engine::Implementation::release_held(Time now) {
  const auto decided = [this](const MacAddress& destination) { return !router_.repairing(destination); };
  for (auto& [destination, frames] : held_.take(decided)) {
    const routing::Route* route = router_.route_to(destination, now);
    for (transport::HopFrame& frame : frames) {
      if (route != nullptr && way_of(frame)->source != route->next_hop) {
        hops_.enqueue(route->next_hop, std::move(frame));
      }
    }
  }
}

}  // namespace adhoc_communication
