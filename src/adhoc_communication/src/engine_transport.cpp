// Packets on their way: delivered, passed on, acknowledged, put on the air in the order of their priority.
#include <algorithm>

#include "engine_implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {

using wire::FrameType;

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

void Engine::Implementation::deliver_data(const wire::Data& data, Time now) {
  const routing::Robot* robot = directory_.find(data.source);
  if (robot == nullptr) return router_.search({data.source, {}}, now);  // who is that?
  const std::string source = robot->name;
  for (const auto& complete : receivers_.take(data, now)) {
    deliver_packet(Carrier::kStream, source, complete.image, complete.hops, now);
  }
}

/// Whoever put the packets together that had to make room forgets them.
void Engine::Implementation::forget_evicted(Time now) {
  for (const transport::Reassembly::Key& key : reassembly_.take_evicted()) {
    if (key.carrier >= transport::Reassembly::kGroup) {
      distributor_.evicted(key);
    } else if (key.carrier == transport::Reassembly::kBroadcast) {
      broadcast_receiver_.evicted(key);
    } else {
      receivers_.evicted(key, now);
    }
  }
}

/// What is said to a group's root, or by it, comes by a stream, which tells who says it as far as anything does.
bool Engine::Implementation::admits(Carrier carrier, const std::string& source, const transport::Packet& packet) const {
  if (carrier == Carrier::kStream) return true;
  const std::string group = carrier == Carrier::kGroup ? multicast::group_of(source) : "";
  return packet.kind == transport::PacketKind::kUser && packet.group == group;
}

void Engine::Implementation::deliver_packet(Carrier carrier, const std::string& source, const Bytes& image,
                                            std::uint8_t hops, Time now) {
  // A flood is one frame, which may claim to be any number of zeros.
  const std::size_t little = std::max(kMostFloodOctets, 2 * image.size());
  const std::size_t most = carrier == Carrier::kBroadcast ? little : SIZE_MAX;
  std::optional<transport::Packet> packet = transport::parse(image, std::min(options_.max_packet_size, most));
  if (!packet || !admits(carrier, source, *packet)) return malformed();
  if (packet->kind != transport::PacketKind::kUser) {
    if (packet->unpacked_size > little || !transport::unpack(packet->payload, packet->unpacked_size))
      return malformed();
    return on_group_packet(source, *packet, now);
  }
  if (memberships_.refuses(packet->group)) return;
  auto& by_hops = statistics_.packets_received_by_hops;
  if (by_hops.size() < hops) by_hops.resize(hops);
  ++by_hops[hops - 1];
  report(PacketReceived{source, packet->group, packet->topic, packet->payload_type, std::move(packet->payload), hops,
                        packet->latched, packet->unpacked_size});
}

void Engine::Implementation::on_broadcast_data(const wire::FrameHeader& header, const wire::BroadcastData& data,
                                               Time now) {
  const routing::Robot* robot = directory_.find(header.sender);
  if (robot == nullptr) return;
  const auto image = broadcast_receiver_.take(header.sender, wire::boot_tag(header.boot_id), data, now);
  if (image) deliver_packet(Carrier::kBroadcast, robot->name, *image, 1, now);
}

void Engine::Implementation::on_flood(const wire::Flood& flood, Time now) {
  if (flood.source == self_.address || !runs_.told(flood.source, flood.source_boot, now)) return;
  const routing::Robot* robot = directory_.find(flood.source);
  if (robot != nullptr && robot->name != flood.source_name) return malformed();
  if (!flood_.take(flood, now)) return;
  deliver_packet(Carrier::kBroadcast, flood.source_name, flood.image, static_cast<std::uint8_t>(flood.hop_count + 1),
                 now);
}

/// Frames to the neighbour go unanswered, it fell silent, or it has restarted.
void Engine::Implementation::link_lost(const MacAddress& neighbor, Time now) {
  forwarder_.link_lost(neighbor, now);
  distributor_.link_lost(neighbor, now);
}

void Engine::Implementation::serve_streams(Time now) {
  for (const transport::Undelivered& packet : streams_.serve(now)) finish(packet.id, false, packet.reason, now);
}

void Engine::Implementation::fail_unreachable(Time now) {
  for (const routing::DiscoveryFailure& failure : router_.take_failures(now)) {
    if (failure.repair) {
      distributor_.unreachable(failure.target.address, {}, true, now);
      touched_ = true;  // own packets may wait for that route, too
      continue;
    }
    receivers_.forgo(failure.target.address);
    std::string name = failure.target.name;
    if (const routing::Robot* robot = directory_.find(failure.target.address)) name = robot->name;
    const std::string reason = failure.elapsed > Time(0)
                                   ? "no route to " + name + " after " + seconds_text(failure.elapsed)
                                   : "no route to " + name + ": too many searches at once";
    distributor_.unreachable(failure.target.address, reason, false, now);
    for (const SendId id : streams_.abandon(name, now)) finish(id, false, reason, now);
  }
}

}  // namespace adhoc_communication
