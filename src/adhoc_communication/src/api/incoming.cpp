#include "api/incoming.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {

void Incoming::take(const wire::Data& data, Time now) {
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
bool Incoming::admits(Carrier carrier, const std::string& source, const transport::Packet& packet) const {
  if (carrier == Carrier::kStream) return true;
  const std::string group = carrier == Carrier::kGroup ? multicast::group_of(source) : "";
  return packet.kind == transport::PacketKind::kUser && packet.group == group;
}

void Incoming::deliver(Carrier carrier, const std::string& source, wire::BootTag boot, Bytes image, std::uint8_t hops,
                       Time now) {
  // One frame, which may claim to be any number of zeros, to each robot of the team.
  const std::size_t most = carrier == Carrier::kFlood ? transport::FloodRelay::kMostUnpacked : SIZE_MAX;
  std::optional<transport::Packet> packet = transport::parse(std::move(image), std::min(max_packet_size_, most));
  if (!packet || !admits(carrier, source, *packet)) return malformed();
  if (packet->kind != transport::PacketKind::kUser) {
    // Unpacked here and now, so that is not to take long; a copy, which may be large, carries what is packed itself.
    if (packet->unpacked_size > transport::FloodRelay::kMostUnpacked ||
        !transport::unpack(packet->payload, packet->unpacked_size)) {
      return malformed();
    }
    if (!groups_.take(source, boot, *packet, now)) malformed();
    return outgoing_.settle(now);
  }
  if (groups_.refuses(packet->group)) return;
  auto& by_hops = statistics_.packets_received_by_hops;
  if (by_hops.size() < hops) by_hops.resize(hops);
  ++by_hops[hops - 1];
  events_.add(PacketReceived{source, packet->group, packet->topic, packet->payload_type, std::move(packet->payload),
                             hops, packet->latched, packet->unpacked_size});
}

/// Whoever put the packets together that had to make room forgets them.
void Incoming::forget_evicted(Time now) {
  for (const transport::Reassembly::Key& key : reassembly_.take_evicted()) {
    if (key.carrier >= transport::Reassembly::kGroup) {
      distributor_.evicted(key);
    } else if (key.carrier == transport::Reassembly::kBroadcast) {
      broadcasts_.evicted(key);
    } else {
      receivers_.evicted(key, now);
    }
  }
}

void Incoming::take_group_packets(Time now) {
  for (multicast::Arrived& arrived : distributor_.take_arrived()) {
    if (!groups_.takes_part(arrived.root)) continue;
    const routing::Robot root = *directory_.find(arrived.root);
    deliver(Carrier::kGroup, root.name, root.boot, std::move(arrived.image), arrived.hops, now);
  }
}

}  // namespace adhoc_communication
