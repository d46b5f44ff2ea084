// Packets put together: for the host, or about groups.
#include <algorithm>
#include <utility>

#include "engine/implementation.hpp"

namespace adhoc_communication {

void Engine::Implementation::deliver_data(const wire::Data& data, Time now) {
  const routing::Robot* robot = directory_.find(data.source);
  if (robot == nullptr) {  // who is that?
    router_.search_for_others({data.source, {}}, now);
    return;
  }
  const std::string source = robot->name;
  for (auto& complete : receivers_.take(data, now)) {
    deliver(Carrier::kStream, source, data.source_boot, std::move(complete.image), complete.hops, now);
  }
}

/// What is said to a group's root, or by it, comes by a stream, which tells who says it as far as anything does.
bool Engine::Implementation::admits(Carrier carrier, const std::string& source, const transport::Packet& packet) const {
  if (carrier == Carrier::kStream) return true;
  const std::string group = carrier == Carrier::kGroup ? multicast::group_of(source) : "";
  return packet.kind == transport::PacketKind::kUser && packet.group == group;
}

void Engine::Implementation::deliver(Carrier carrier, const std::string& source, wire::BootTag boot, Bytes image,
                                     std::uint8_t hops, Time now) {
  // One frame, which may claim to be any number of zeros, to each robot of the team.
  const std::size_t most = carrier == Carrier::kFlood ? kMostFloodOctets : SIZE_MAX;
  std::optional<transport::Packet> packet =
      transport::parse(std::move(image), std::min(options_.max_packet_size, most));
  if (!packet || !admits(carrier, source, *packet)) return malformed();
  if (packet->kind != transport::PacketKind::kUser) {
    // Unpacked here and now, so that is not to take long; a copy, which may be large, carries what is packed itself.
    if (packet->unpacked_size > kMostFloodOctets || !transport::unpack(packet->payload, packet->unpacked_size)) {
      return malformed();
    }
    if (!groups_.take(source, boot, *packet, now)) malformed();
    return settle_groups(now);
  }
  if (groups_.refuses(packet->group)) return;
  auto& by_hops = statistics_.packets_received_by_hops;
  if (by_hops.size() < hops) by_hops.resize(hops);
  ++by_hops[hops - 1];
  report(PacketReceived{source, packet->group, packet->topic, packet->payload_type, std::move(packet->payload), hops,
                        packet->latched, packet->unpacked_size});
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

void Engine::Implementation::take_group_packets(Time now) {
  for (multicast::Arrived& arrived : distributor_.take_arrived()) {
    if (!groups_.takes_part(arrived.root)) continue;
    const routing::Robot root = *directory_.find(arrived.root);
    deliver(Carrier::kGroup, root.name, root.boot, std::move(arrived.image), arrived.hops, now);
  }
}

}  // namespace adhoc_communication
