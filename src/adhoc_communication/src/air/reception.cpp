#include "air/reception.hpp"

#include <utility>

namespace adhoc_communication::air {

using wire::FrameType;

void Reception::receive(const Frame& frame, Time now) {
  if (frame.destination != wire::kEverybody && frame.destination != layers_.self.address) return;
  ++layers_.statistics.frames_received;
  const std::size_t octets = frame.bytes.size() + wire::kEthernetHeaderSize;
  layers_.statistics.bytes_received += octets;
  const std::optional<security::OpenedFrame> opened = layers_.guard.open(frame, now);
  if (!opened) return;
  const wire::FrameHeader& header = opened->header;
  if (lost_artificially(header.type)) return;
  ++layers_.statistics.frames_received_by_type[static_cast<std::size_t>(header.type)];
  layers_.statistics.bytes_received_by_type[static_cast<std::size_t>(header.type)] += octets;
  if (!layers_.admission.admits(*opened, now)) return layers_.presence.ask_in_doubt(header.sender, now);
  if (!hear(header, now)) return;
  const bool wants_acknowledgment =
      header.next_hop != wire::kEverybody && (header.flags & wire::kWantsAcknowledgment) != 0;
  if (header.next_hop == layers_.self.address) layers_.neighbors.addressed(header.sender, now);
  if (wants_acknowledgment && !layers_.hops.take(header, now)) return;
  dispatch(header, opened->body, now);
  layers_.incoming.forget_evicted(now);
}

/// Enters the sender into the table of neighbours; false if there is no room for it.
bool Reception::hear(const wire::FrameHeader& header, Time now) {
  const wire::BootTag boot = wire::boot_tag(header.boot_id);
  const routing::Neighbor* before = layers_.neighbors.find(header.sender);
  const bool restarted = before != nullptr && before->boot != boot;
  if (before == nullptr || restarted || layers_.neighbors.is_lost(*before, now)) {
    layers_.rhythm.happened(now);
    layers_.rhythm.greet(now);
  }
  if (restarted) layers_.links.lost(header.sender, now);
  if (before == nullptr || restarted) layers_.distributor.appeared({header.sender, boot});
  if (layers_.neighbors.heard(header.sender, boot, now) == nullptr) return false;
  layers_.directory.traffic(header.sender, boot, now);
  layers_.hops.heard(header.sender, now);
  return true;
}

bool Reception::lost_artificially(FrameType type) {
  if (loss_ratio_ <= 0.0) return false;
  const bool concerned = type == FrameType::kData || type == FrameType::kTransportAcknowledgment ||
                         type == FrameType::kHopAcknowledgment || type == FrameType::kBroadcastData ||
                         type == FrameType::kFlood || type == FrameType::kGroupData ||
                         type == FrameType::kGroupReport || type == FrameType::kGroupReceipts;
  return concerned && layers_.random.chance(loss_ratio_);
}

void Reception::dispatch(const wire::FrameHeader& header, wire::Reader body, Time now) {
  const MacAddress& from = header.sender;
  const auto with = [this](auto message, auto handle) {
    if (!message) return malformed();
    handle(std::move(*message));
  };
  switch (header.type) {
    case FrameType::kBeacon:
      return with(wire::read_beacon(body),
                  [&](auto beacon) { layers_.presence.on_beacon(from, wire::boot_tag(header.boot_id), beacon, now); });
    case FrameType::kRouteRequest:
      return with(wire::read_route_request(body), [&](auto request) { layers_.router.on_request(from, request, now); });
    case FrameType::kRouteReply:
      return with(wire::read_route_reply(body), [&](auto reply) { layers_.router.on_reply(from, reply, now); });
    case FrameType::kRouteReplyAcknowledgment:
      return body.at_end() ? layers_.router.on_reply_acknowledgment(from, now) : malformed();
    case FrameType::kRouteError:
      return with(wire::read_route_error(body), [&](auto error) { layers_.router.on_error(from, error, now); });
    case FrameType::kHopAcknowledgment:
      return with(wire::read_hop_acknowledgment(body),
                  [&](auto acknowledgment) { layers_.hops.on_acknowledgment(from, acknowledgment, now); });
    case FrameType::kData:
      return with(wire::read_data(body), [&](auto data) {
        ++layers_.statistics.unicast_data.received;
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
        if (activation.root != layers_.self.address && !layers_.runs.told(activation.root, activation.root_boot, now))
          return;
        layers_.distributor.on_activation({from, wire::boot_tag(header.boot_id)}, activation,
                                          layers_.groups.takes_part(activation.root), now);
      });
    case FrameType::kGroupRefusal:
      return with(wire::read_group_refusal(body),
                  [&](auto refusal) { layers_.distributor.on_refusal(from, refusal, now); });
    case FrameType::kGroupData:
      return with(wire::read_group_data(body), [&](auto data) {
        const bool own = data.root == layers_.self.address;
        if (data.flooded &&
            !(own ? data.root_boot == layers_.self.boot : layers_.runs.told(data.root, data.root_boot, now)))
          return;
        const bool member = layers_.groups.is_member_of(data.root) && layers_.runs.lives(data.root, data.root_boot);
        if (layers_.distributor.on_data(from, header.counter, data, member, now))
          ++layers_.statistics.group_data.received;
      });
    case FrameType::kGroupReport:
      return with(wire::read_group_report(body),
                  [&](auto report) { layers_.distributor.on_report(from, report, now); });
    case FrameType::kGroupReceipts:
      return with(wire::read_group_receipts(body),
                  [&](auto receipts) { layers_.distributor.on_receipts(receipts, now); });
  }
}

void Reception::on_data(const MacAddress& from, wire::Data data, Time now) {
  if (data.source == layers_.self.address || !layers_.runs.told(data.source, data.source_boot, now)) return;
  layers_.directory.traffic(data.source, data.source_boot, now);
  layers_.router.used(data.source, data.destination, from, now);
  if (data.destination == layers_.self.address) return layers_.incoming.take(data, now);
  layers_.forwarder.forward(from, std::move(data), now);
}

void Reception::on_transport_acknowledgment(const MacAddress& from, wire::TransportAcknowledgment acknowledgment,
                                            Time now) {
  if (acknowledgment.source == layers_.self.address) return;
  if (!layers_.runs.told(acknowledgment.source, acknowledgment.source_boot, now)) return;
  layers_.directory.traffic(acknowledgment.source, acknowledgment.source_boot, now);
  layers_.router.used(acknowledgment.source, acknowledgment.destination, from, now);
  if (acknowledgment.destination != layers_.self.address) {
    return layers_.forwarder.forward(from, std::move(acknowledgment), now);
  }
  if (acknowledgment.destination_boot != layers_.self.boot) return;
  for (const SendId id : layers_.streams.acknowledged(acknowledgment, now)) layers_.outgoing.finish(id, true, {}, now);
}

void Reception::on_broadcast_data(const wire::FrameHeader& header, const wire::BroadcastData& data, Time now) {
  const routing::Robot* robot = layers_.directory.find(header.sender);
  if (robot == nullptr) return;
  auto image = layers_.broadcasts.take(header.sender, wire::boot_tag(header.boot_id), data, now);
  if (image)
    layers_.incoming.deliver(Incoming::Carrier::kBroadcast, robot->name, robot->boot, std::move(*image), 1, now);
}

void Reception::on_flood(const wire::Flood& flood, Time now) {
  if (flood.source == layers_.self.address || !layers_.runs.told(flood.source, flood.source_boot, now)) return;
  const routing::Robot* robot = layers_.directory.find(flood.source);
  if (robot != nullptr && robot->name != flood.source_name) return malformed();
  if (!layers_.floods.take(flood, now)) return;
  const auto hops = static_cast<std::uint8_t>(flood.hop_count + 1);
  layers_.incoming.deliver(Incoming::Carrier::kFlood, flood.source_name, flood.source_boot, flood.image, hops, now);
}

}  // namespace adhoc_communication::air
