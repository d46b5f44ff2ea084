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
  const std::uint8_t stream = data.stream;
  forward(from, std::move(data), FrameType::kData, stream, now);
}

void Engine::Implementation::on_transport_acknowledgment(const MacAddress& from,
                                                         wire::TransportAcknowledgment acknowledgment, Time now) {
  if (acknowledgment.source == self_.address) return;
  if (!runs_.told(acknowledgment.source, acknowledgment.source_boot, now)) return;
  directory_.traffic(acknowledgment.source, acknowledgment.source_boot, now);
  router_.used(acknowledgment.source, acknowledgment.destination, from, now);
  if (acknowledgment.destination != self_.address) {
    return forward(from, std::move(acknowledgment), FrameType::kTransportAcknowledgment, 0, now);
  }
  if (acknowledgment.destination_boot != self_.boot) return;
  const routing::Robot* robot = directory_.find(acknowledgment.source);
  if (robot == nullptr) return;
  Stream* stream = streams_.find({robot->name, acknowledgment.stream});
  if (stream == nullptr || stream->address != acknowledgment.source) return;
  for (const SendId id : stream->sender.acknowledged(acknowledgment, now)) finish(id, true, {}, now);
}

template <typename Message>
void Engine::Implementation::forward(const MacAddress& from, Message message, FrameType type, std::uint8_t priority,
                                     Time now) {
  if (message.hops >= wire::kFarthestHop) return;
  const MacAddress destination = message.destination;
  const routing::Route* route = router_.route_to(destination, now);
  ++message.hops;
  if (route == nullptr &&
      (router_.repairing(destination) || router_.repair_late(destination, message.source, from, now))) {
    held_.add(destination, {type, to_bytes(message), priority, from});
    return;
  }
  if (route == nullptr || route->next_hop == from) return router_.no_route_for(destination, from, now);
  // A full queue loses the frame; the source repeats it when the destination misses it.
  hops_.enqueue(route->next_hop, {type, to_bytes(message), priority, from});
}

void Engine::Implementation::deliver_data(const wire::Data& data, Time now) {
  const routing::Robot* robot = directory_.find(data.source);
  if (robot == nullptr) return router_.search({data.source, {}}, now);  // who is that?
  transport::StreamReceiver* receiver = receiver_for(data, now);
  const std::string source = robot->name;
  for (const auto& complete : receiver->take(data, now)) {
    deliver_packet(Carrier::kStream, source, complete.image, complete.hops, now);
  }
}

transport::StreamReceiver* Engine::Implementation::receiver_for(const wire::Data& data, Time) {
  const auto* known = receivers_.find(data.source);
  if (known != nullptr && (*known)->boot() != data.source_boot) {
    receivers_.erase(data.source);
    known = nullptr;
  }
  if (known == nullptr && receivers_.size() >= kMostReceivers) {
    const auto& all = receivers_.all();
    const auto idle_longest = std::min_element(all.begin(), all.end(), [](const auto& a, const auto& b) {
      return a.second->last_used() < b.second->last_used();
    });
    receivers_.erase(MacAddress(idle_longest->first));
  }
  const auto& receiver = receivers_.use(data.source, [&] {
    return std::make_unique<transport::StreamReceiver>(data.source, data.source_boot, options_.max_packet_size,
                                                       reassembly_);
  });
  return receiver.get();
}

/// Whoever put the packets together that had to make room forgets them.
void Engine::Implementation::forget_evicted(Time now) {
  for (const transport::Reassembly::Key& key : reassembly_.take_evicted()) {
    if (key.carrier >= transport::Reassembly::kGroup) {
      distributor_.evicted(key);
    } else if (key.carrier == transport::Reassembly::kBroadcast) {
      broadcast_receiver_.evicted(key);
    } else if (const auto* known = receivers_.find(key.source); known != nullptr && (*known)->boot() == key.boot) {
      transport::StreamReceiver& receiver = *receivers_.use(key.source, [] { return nullptr; });
      receiver.evicted(key.carrier, key.packet, now);
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

void Engine::Implementation::acknowledge_streams(Time now) {
  for (const auto& [source, entry] : receivers_.busy()) {
    transport::StreamReceiver* receiver = entry->get();
    for (std::size_t stream = 0; stream < transport::kPriorities; ++stream) {
      if (receiver->due(stream) > now) continue;
      const routing::Route* route = router_.route_to(source, now);
      if (route == nullptr) {
        router_.search({source, {}}, now);
        receiver->postpone(stream, now + std::chrono::milliseconds(20));
        continue;
      }
      wire::TransportAcknowledgment acknowledgment = receiver->acknowledge(stream);
      acknowledgment.source = self_.address;
      acknowledgment.source_boot = self_.boot;
      acknowledgment.destination = source;
      acknowledgment.destination_boot = receiver->boot();
      hops_.unicast(route->next_hop, FrameType::kTransportAcknowledgment, to_bytes(acknowledgment));
    }
  }
}

void Engine::Implementation::serve_streams(Time now) {
  for (const auto& [key, stream] : streams_.busy()) {
    if (!stream->sender.idle()) serve_stream(key, *stream, now);
    record_segments(key, *stream, now);
  }
  streams_.settle([](Stream& stream) {
    if (stream.sender.idle()) stream.next_hop.reset();
    return stream.sender.idle();
  });
}

/// Keeps the route of a stream with work, and its end-to-end timer.
void Engine::Implementation::serve_stream(const StreamKey& key, Stream& stream, Time now) {
  stream.address = directory_.address_of(key.first);
  const routing::Route* route = stream.address ? router_.route_to(*stream.address, now) : nullptr;
  if (route == nullptr) {
    stream.next_hop.reset();
    stream.sender.route_missing(now);
    return router_.search({stream.address.value_or(MacAddress{}), key.first}, now);
  }
  if (stream.next_hop != route->next_hop) {
    stream.next_hop = route->next_hop;
    stream.sender.route_changed(now);
  }
  for (const auto& [id, elapsed, no_room] : stream.sender.expire(options_.num_e2e_retrans, now, random_)) {
    finish(id, false,
           key.first + (no_room ? " had no room for it for " : " did not acknowledge within ") + seconds_text(elapsed),
           now);
  }
}

void Engine::Implementation::fail_unreachable(Time now) {
  for (const routing::DiscoveryFailure& failure : router_.take_failures(now)) {
    if (failure.repair) {
      distributor_.unreachable(failure.target.address, {}, true, now);
      touched_ = true;  // own packets may wait for that route, too
      continue;
    }
    if (const auto* receiver = receivers_.find(failure.target.address)) {
      for (std::size_t stream = 0; stream < transport::kPriorities; ++stream) (*receiver)->forgo(stream);
    }
    std::string name = failure.target.name;
    if (const routing::Robot* robot = directory_.find(failure.target.address)) name = robot->name;
    const std::string reason = failure.elapsed > Time(0)
                                   ? "no route to " + name + " after " + seconds_text(failure.elapsed)
                                   : "no route to " + name + ": too many searches at once";
    distributor_.unreachable(failure.target.address, reason, false, now);
    for (std::uint8_t priority = 0; priority < transport::kPriorities; ++priority) {
      Stream* stream = streams_.find({name, priority});
      if (stream == nullptr) continue;
      for (const SendId id : stream->sender.abandon(now)) finish(id, false, reason, now);
      record_segments({name, priority}, *stream, now);
    }
  }
}

}  // namespace adhoc_communication
