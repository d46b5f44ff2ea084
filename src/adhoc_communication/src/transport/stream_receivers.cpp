#include "transport/stream_receivers.hpp"

#include <algorithm>

namespace adhoc_communication::transport {
namespace {

constexpr Time kUntilRoute = std::chrono::milliseconds(20);  ///< between looks whether there is a way back

}  // namespace

std::vector<StreamReceiver::Complete> StreamReceivers::take(const wire::Data& data, Time now) {
  return receiver_for(data).take(data, now);
}

StreamReceiver& StreamReceivers::receiver_for(const wire::Data& data) {
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
  const auto make = [&] {
    return std::make_unique<StreamReceiver>(data.source, data.source_boot, largest_packet_, reassembly_);
  };
  return *receivers_.use(data.source, make);
}

void StreamReceivers::evicted(const Reassembly::Key& key, Time now) {
  const auto* known = receivers_.find(key.source);
  if (known == nullptr || (*known)->boot() != key.boot) return;
  receivers_.use(key.source, [] { return nullptr; })->evicted(key.carrier, key.packet, now);
}

void StreamReceivers::forgo(const MacAddress& source) {
  const auto* receiver = receivers_.find(source);
  if (receiver == nullptr) return;
  for (std::size_t stream = 0; stream < kPriorities; ++stream) (*receiver)->forgo(stream);
}

void StreamReceivers::acknowledge(Time now) {
  for (const auto& [source, receiver] : receivers_.busy()) {
    for (std::size_t stream = 0; stream < kPriorities; ++stream) {
      if ((*receiver)->due(stream) <= now) acknowledge(source, **receiver, stream, now);
    }
  }
}

void StreamReceivers::acknowledge(const MacAddress& source, StreamReceiver& receiver, std::size_t stream, Time now) {
  const routing::Route* route = router_.route_to(source, now);
  if (route == nullptr) {
    if (!router_.search_for_others({source, {}}, now)) return receiver.forgo(stream);
    return receiver.postpone(stream, now + kUntilRoute);
  }
  wire::TransportAcknowledgment acknowledgment = receiver.acknowledge(stream);
  acknowledgment.source = self_.address;
  acknowledgment.source_boot = self_.boot;
  acknowledgment.destination = source;
  acknowledgment.destination_boot = receiver.boot();
  outbox_.unicast(route->next_hop, wire::FrameType::kTransportAcknowledgment, to_bytes(acknowledgment));
}

void StreamReceivers::expire(Time now) {
  for (const auto& [source, receiver] : receivers_.all()) receiver->expire(now);
}

Time StreamReceivers::next_deadline() const {
  Time next = Time::max();
  for (const auto& [source, receiver] : receivers_.busy()) next = std::min(next, (*receiver)->next_deadline());
  return next;
}

void StreamReceivers::settle() {
  receivers_.settle([](const auto& receiver) { return receiver->next_deadline() == Time::max(); });
}

}  // namespace adhoc_communication::transport
