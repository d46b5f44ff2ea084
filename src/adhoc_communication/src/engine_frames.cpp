// Frames in and out.
#include <algorithm>
#include <stdexcept>

#include "engine_implementation.hpp"

namespace adhoc_communication {

using wire::FrameType;

void Engine::Implementation::receive(const Frame& frame, Time now) {
  touch(now);
  if (frame.destination != wire::kEverybody && frame.destination != self_.address) return;
  ++statistics_.frames_received;
  const std::size_t octets = frame.bytes.size() + wire::kEthernetHeaderSize;
  statistics_.bytes_received += octets;
  const std::optional<security::OpenedFrame> opened = guard_.open(frame, now);
  if (!opened) return;
  const wire::FrameHeader& header = opened->header;
  if (lost_artificially(header.type)) return;
  ++statistics_.frames_received_by_type[static_cast<std::size_t>(header.type)];
  statistics_.bytes_received_by_type[static_cast<std::size_t>(header.type)] += octets;
  if (!guard_.proven(header) && !proves_itself(*opened, now)) return;
  if (!lives(*opened, now)) return;
  if (!hear(header, now)) return;

  if (header.next_hop != wire::kEverybody && (header.flags & wire::kWantsAcknowledgment) != 0) {
    if (!hops_.take(header, now)) return;
  }
  dispatch(header, opened->body, now);
  forget_evicted(now);
}

/// A run is believed to be alive now once a beacon of it names this robot's boot id; until then this robot only says
/// that it hears it.
bool Engine::Implementation::proves_itself(const security::OpenedFrame& opened, Time now) {
  const wire::FrameHeader& header = opened.header;
  const auto beacon = header.type == FrameType::kBeacon ? wire::read_beacon(opened.body) : std::nullopt;
  const bool echo = beacon && std::any_of(beacon->heard.begin(), beacon->heard.end(), [&](const auto& heard) {
                      return heard.tag == wire::neighbor_tag(self_.boot);
                    });
  if (echo) {
    guard_.prove(header);
    return true;
  }
  ++statistics_.frames_dropped.unproven;
  if (beacon && neighbors_.candidate(header.sender, wire::boot_tag(header.boot_id), now)) rhythm_.greet(now);
  return false;
}

/// The frame is one of the run that lives.
bool Engine::Implementation::lives(const security::OpenedFrame& opened, Time now) {
  const wire::FrameHeader& header = opened.header;
  const wire::BootTag boot = wire::boot_tag(header.boot_id);
  if (header.type == FrameType::kBeacon && !runs_.lives(header.sender, boot)) {
    if (const auto beacon = wire::read_beacon(opened.body)) runs_.beacon(header.sender, boot, beacon->alive, now);
  }
  return runs_.heard(header.sender, boot, header.counter, now);
}

void Engine::Implementation::set_keys(std::vector<TeamKey> keys) {
  if (keys.empty() == guard_.seals()) {
    throw std::invalid_argument(guard_.seals() ? "a sealed team cannot be left without a key"
                                               : "an open team cannot be given a key while it works");
  }
  guard_.set_keys(std::move(keys));
}

/// Enters the sender into the table of neighbours; false if there is no room for it.
bool Engine::Implementation::hear(const wire::FrameHeader& header, Time now) {
  const wire::BootTag boot = wire::boot_tag(header.boot_id);
  const routing::Neighbor* before = neighbors_.find(header.sender);
  const bool restarted = before != nullptr && before->boot != boot;
  if (before == nullptr || restarted || neighbors_.is_lost(*before, now)) {
    rhythm_.happened(now);
    rhythm_.greet(now);
  }
  if (restarted) link_lost(header.sender, now);
  if (neighbors_.heard(header.sender, boot, now) == nullptr) return false;
  directory_.traffic(header.sender, boot, now);
  hops_.heard(header.sender, now);
  return true;
}

bool Engine::Implementation::lost_artificially(FrameType type) {
  if (options_.loss_ratio <= 0.0) return false;
  const bool concerned = type == FrameType::kData || type == FrameType::kTransportAcknowledgment ||
                         type == FrameType::kHopAcknowledgment || type == FrameType::kBroadcastData ||
                         type == FrameType::kFlood || type == FrameType::kGroupData || type == FrameType::kGroupReport;
  return concerned && random_.chance(options_.loss_ratio);
}

void Engine::Implementation::dispatch(const wire::FrameHeader& header, wire::Reader body, Time now) {
  const MacAddress& from = header.sender;
  const auto with = [this](auto message, auto handle) {
    if (!message) return malformed();
    handle(std::move(*message));
  };
  switch (header.type) {
    case FrameType::kBeacon:
      return with(wire::read_beacon(body),
                  [&](auto beacon) { on_beacon(from, wire::boot_tag(header.boot_id), beacon, now); });
    case FrameType::kRouteRequest:
      return with(wire::read_route_request(body), [&](auto request) { router_.on_request(from, request, now); });
    case FrameType::kRouteReply:
      return with(wire::read_route_reply(body), [&](auto reply) { router_.on_reply(from, reply, now); });
    case FrameType::kRouteReplyAcknowledgment:
      return body.at_end() ? router_.on_reply_acknowledgment(from, now) : malformed();
    case FrameType::kRouteError:
      return with(wire::read_route_error(body), [&](auto error) { router_.on_error(from, error, now); });
    case FrameType::kHopAcknowledgment:
      return with(wire::read_hop_acknowledgment(body),
                  [&](auto acknowledgment) { hops_.on_acknowledgment(from, acknowledgment, now); });
    case FrameType::kData:
      return with(wire::read_data(body), [&](auto data) {
        ++statistics_.unicast_data.received;
        on_data(from, std::move(data), now);
      });
    case FrameType::kTransportAcknowledgment:
      return with(wire::read_transport_acknowledgment(body),
                  [&](auto acknowledgment) { on_transport_acknowledgment(from, std::move(acknowledgment), now); });
    case FrameType::kBroadcastData:
      return with(wire::read_broadcast_data(body), [&](auto data) { on_broadcast_data(header, data, now); });
    case FrameType::kFlood:
      return with(wire::read_flood(body), [&](auto flood) { on_flood(flood, now); });
    case FrameType::kGroupActivation:
      return with(wire::read_group_activation(body), [&](auto activation) {
        if (activation.root != self_.address && !runs_.told(activation.root, activation.root_boot, now)) return;
        distributor_.on_activation(from, activation, takes_part(activation.root), now);
      });
    case FrameType::kGroupRefusal:
      return with(wire::read_group_refusal(body), [&](auto refusal) { distributor_.on_refusal(from, refusal, now); });
    case FrameType::kGroupData:
      return with(wire::read_group_data(body), [&](auto data) {
        if (distributor_.on_data(from, header.counter, data, now)) ++statistics_.group_data.received;
      });
    case FrameType::kGroupReport:
      return with(wire::read_group_report(body), [&](auto report) { distributor_.on_report(from, report, now); });
  }
}

}  // namespace adhoc_communication
