// Frames in.
#include <algorithm>

#include "engine/implementation.hpp"

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
  if (!admission_.admits(*opened, now)) return ask_in_doubt(header.sender, now);
  if (!hear(header, now)) return;
  const bool wants_acknowledgment =
      header.next_hop != wire::kEverybody && (header.flags & wire::kWantsAcknowledgment) != 0;
  if (wants_acknowledgment && !hops_.take(header, now)) return;
  dispatch(header, opened->body, now);
  forget_evicted(now);
}

/// Another run may live at that address than the one that is known.
void Engine::Implementation::ask_in_doubt(const MacAddress& robot, Time now) {
  if (runs_.wants_answer(robot, neighbors_.two_way(robot, now), now)) presence_.ask(robot, now);
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
  if (before == nullptr || restarted) distributor_.appeared({header.sender, boot});
  if (neighbors_.heard(header.sender, boot, now) == nullptr) return false;
  directory_.traffic(header.sender, boot, now);
  hops_.heard(header.sender, now);
  return true;
}

bool Engine::Implementation::lost_artificially(FrameType type) {
  if (options_.loss_ratio <= 0.0) return false;
  const bool concerned = type == FrameType::kData || type == FrameType::kTransportAcknowledgment ||
                         type == FrameType::kHopAcknowledgment || type == FrameType::kBroadcastData ||
                         type == FrameType::kFlood || type == FrameType::kGroupData ||
                         type == FrameType::kGroupReport || type == FrameType::kGroupReceipts;
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
                  [&](auto beacon) { presence_.on_beacon(from, wire::boot_tag(header.boot_id), beacon, now); });
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
        distributor_.on_activation({from, wire::boot_tag(header.boot_id)}, activation,
                                   groups_.takes_part(activation.root), now);
      });
    case FrameType::kGroupRefusal:
      return with(wire::read_group_refusal(body), [&](auto refusal) { distributor_.on_refusal(from, refusal, now); });
    case FrameType::kGroupData:
      return with(wire::read_group_data(body), [&](auto data) {
        const bool own = data.root == self_.address;
        if (data.flooded && !(own ? data.root_boot == self_.boot : runs_.told(data.root, data.root_boot, now))) return;
        const bool member = groups_.is_member_of(data.root) && runs_.lives(data.root, data.root_boot);
        if (distributor_.on_data(from, header.counter, data, member, now)) ++statistics_.group_data.received;
      });
    case FrameType::kGroupReport:
      return with(wire::read_group_report(body), [&](auto report) { distributor_.on_report(from, report, now); });
    case FrameType::kGroupReceipts:
      return with(wire::read_group_receipts(body), [&](auto receipts) { distributor_.on_receipts(receipts, now); });
  }
}

void Engine::Implementation::on_data(const MacAddress& from, wire::Data data, Time now) {
  if (data.source == self_.address || !runs_.told(data.source, data.source_boot, now)) return;
  directory_.traffic(data.source, data.source_boot, now);
  router_.used(data.source, data.destination, from, now);
  if (data.destination == self_.address) return deliver_data(data, now);
  forwarder_.forward(from, std::move(data), now);
}

void Engine::Implementation::on_transport_acknowledgment(const MacAddress& from,
                                                         wire::TransportAcknowledgment acknowledgment, Time now) {
  if (acknowledgment.source == self_.address) return;
  if (!runs_.told(acknowledgment.source, acknowledgment.source_boot, now)) return;
  directory_.traffic(acknowledgment.source, acknowledgment.source_boot, now);
  router_.used(acknowledgment.source, acknowledgment.destination, from, now);
  if (acknowledgment.destination != self_.address) {
    return forwarder_.forward(from, std::move(acknowledgment), now);
  }
  if (acknowledgment.destination_boot != self_.boot) return;
  for (const SendId id : streams_.acknowledged(acknowledgment, now)) finish(id, true, {}, now);
}

void Engine::Implementation::on_broadcast_data(const wire::FrameHeader& header, const wire::BroadcastData& data,
                                               Time now) {
  const routing::Robot* robot = directory_.find(header.sender);
  if (robot == nullptr) return;
  auto image = broadcast_receiver_.take(header.sender, wire::boot_tag(header.boot_id), data, now);
  if (image) deliver(Carrier::kBroadcast, robot->name, robot->boot, std::move(*image), 1, now);
}

void Engine::Implementation::on_flood(const wire::Flood& flood, Time now) {
  if (flood.source == self_.address || !runs_.told(flood.source, flood.source_boot, now)) return;
  const routing::Robot* robot = directory_.find(flood.source);
  if (robot != nullptr && robot->name != flood.source_name) return malformed();
  if (!flood_.take(flood, now)) return;
  const auto hops = static_cast<std::uint8_t>(flood.hop_count + 1);
  deliver(Carrier::kFlood, flood.source_name, flood.source_boot, flood.image, hops, now);
}

}  // namespace adhoc_communication
