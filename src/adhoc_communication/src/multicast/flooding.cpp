#include "multicast/flooding.hpp"

#include <algorithm>
#include <cmath>

#include "wire/frame_header.hpp"

namespace adhoc_communication::multicast {

void Flooding::take(const MacAddress& from, const wire::GroupData& data, Time now) {
  const Key key = key_of(data);
  const auto known = packets_.find(key);
  if (known != packets_.end()) {
    Packet& packet = known->second;
    packet.senders.insert(from);
    if (packet.sends == 0 && packet.due) prefer_upstream(key, from, now);
    return;
  }
  note_upstream(key, from, now);
  wire::GroupData passed_on = data;
  passed_on.hops = static_cast<std::uint8_t>(std::min<int>(data.hops + 1, wire::kFarthestHop));
  if (data.hops >= wire::kFarthestHop) passed_on.octets.clear();
  add(from, std::move(passed_on), random_.delay(kJitter), now);
}

void Flooding::take_copy(wire::GroupData data, Time now) {
  const MacAddress root = data.root;
  if (packets_.count(key_of(data)) == 0) add(root, std::move(data), random_.delay(kJitter), now);
}

void Flooding::add(const MacAddress& from, wire::GroupData data, Time jitter, Time now) {
  make_room();
  const Key key = key_of(data);
  Packet& packet = packets_[key];
  packet.first = from;
  packet.data = std::move(data);
  if (from != MacAddress{}) packet.senders.insert(from);
  oldest_.push_back(key);
  if (!packet.data.octets.empty()) decide_at(key, packet, now + jitter);
}

void Flooding::make_room() {
  if (packets_.size() < kMostPackets) return;
  const Key key = oldest_.front();
  oldest_.pop_front();
  forget_due(key, packets_.at(key));
  auto& ready = ready_[std::get<2>(key)];
  ready.erase(std::remove(ready.begin(), ready.end(), key), ready.end());
  packets_.erase(key);
}

void Flooding::decide_at(const Key& key, Packet& packet, Time due) {
  forget_due(key, packet);
  packet.due = due;
  due_.emplace(due, key);
}

void Flooding::forget_due(const Key& key, Packet& packet) {
  if (packet.due) due_.erase({*packet.due, key});
  packet.due.reset();
}

/// Of a root that is not heard any more the entry makes room for another one.
void Flooding::note_upstream(const Key& packet, const MacAddress& from, Time now) {
  const MacAddress& root = std::get<0>(packet);
  if (upstream_.size() >= kMostPackets && upstream_.count(root) == 0) {
    upstream_.erase(std::min_element(upstream_.begin(), upstream_.end(),
                                     [](const auto& a, const auto& b) { return a.second.since < b.second.since; }));
  }
  upstream_[root] = {from, packet, now};
}

void Flooding::prefer_upstream(const Key& packet, const MacAddress& from, Time now) {
  const auto found = upstream_.find(std::get<0>(packet));
  if (found == upstream_.end() || found->second.packet != packet || !neighbors_.two_way(from, now)) return;
  MacAddress& chosen = found->second.neighbor;
  if (!neighbors_.two_way(chosen, now) || neighbors_.cost(from) < neighbors_.cost(chosen)) chosen = from;
}

std::optional<MacAddress> Flooding::upstream(const MacAddress& root, wire::BootTag boot) const {
  const auto found = upstream_.find(root);
  if (found == upstream_.end() || std::get<1>(found->second.packet) != boot) return std::nullopt;
  return found->second.neighbor;
}

/// How likely the neighbour has got the packet from none of those that have sent it.
double Flooding::missed(const routing::Neighbor& neighbor, const Packet& packet, Time now) const {
  double missed = std::pow(1.0 - neighbors_.delivery(neighbor, wire::neighbor_tag(self_.boot), now), packet.sends);
  for (const MacAddress& sender : packet.senders) {
    const routing::Neighbor* other = neighbors_.find(sender);
    if (other != nullptr) missed *= 1.0 - neighbors_.delivery(neighbor, wire::neighbor_tag(other->boot), now);
  }
  return missed;
}

bool Flooding::all_have(const Packet& packet, Time now) const {
  return std::all_of(neighbors_.all().begin(), neighbors_.all().end(), [&](const auto& item) {
    const auto& [address, neighbor] = item;
    const bool has_it = address == packet.data.root || packet.senders.count(address) != 0;
    return has_it || !neighbors_.two_way(address, now) || missed(neighbor, packet, now) <= kDoubt;
  });
}

void Flooding::poll(Time now) {
  while (!due_.empty() && due_.begin()->first <= now) {
    const Key key = due_.begin()->second;
    Packet& packet = packets_.at(key);
    forget_due(key, packet);
    const bool own = packet.first == MacAddress{};
    if ((own && packet.sends == 0) || !all_have(packet, now)) {
      ready_[packet.data.stream].push_back(key);
    } else {
      packet.data.octets = {};
    }
  }
}

void Flooding::add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const {
  for (const Key& key : ready_[priority]) hops.push_back(packets_.at(key).first);
}

std::optional<GroupFrame> Flooding::next(std::uint8_t priority, const MacAddress& previous_hop, Time now) {
  auto& ready = ready_[priority];
  const auto found =
      std::find_if(ready.begin(), ready.end(), [&](const Key& key) { return packets_.at(key).first == previous_hop; });
  if (found == ready.end()) return std::nullopt;
  const Key key = *found;
  ready.erase(found);
  Packet& packet = packets_.at(key);
  ++packet.sends;
  GroupFrame frame{wire::kEverybody, to_bytes(packet.data), packet.sends > 1};
  if (packet.sends < kMostSends) {
    decide_at(key, packet, now + kEcho + random_.delay(kEcho / 2));
  } else {
    packet.data.octets = {};
  }
  return frame;
}

}  // namespace adhoc_communication::multicast
