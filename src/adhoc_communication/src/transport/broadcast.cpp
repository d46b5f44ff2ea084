#include "transport/broadcast.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

std::deque<BroadcastSender::Outgoing>::iterator BroadcastSender::find(SendId id) {
  return std::find_if(queue_.begin(), queue_.end(), [id](const Outgoing& packet) { return packet.id == id; });
}

bool BroadcastSender::replace(SendId former, SendId id, const Image& image, std::uint16_t segment_size) {
  const auto packet = find(former);
  if (packet == queue_.end() || packet->next_index > 0) return false;
  *packet = {id, static_cast<std::uint32_t>(id), image, segment_size, 0};
  return true;
}

void BroadcastSender::drop(SendId id) {
  if (const auto packet = find(id); packet != queue_.end()) queue_.erase(packet);
}

std::pair<wire::BroadcastData, std::optional<SendId>> BroadcastSender::next_segment() {
  Outgoing& packet = queue_.front();
  wire::BroadcastData data;
  data.packet = packet.number;
  data.index = packet.next_index++;
  data.total = static_cast<std::uint32_t>(packet.image->size());
  data.segment_size = packet.segment_size;
  const std::size_t begin = std::size_t{data.index} * packet.segment_size;
  const std::size_t end = std::min(begin + packet.segment_size, packet.image->size());
  data.octets.assign(packet.image->begin() + static_cast<std::ptrdiff_t>(begin),
                     packet.image->begin() + static_cast<std::ptrdiff_t>(end));
  std::optional<SendId> finished;
  if (end == packet.image->size()) {
    finished = packet.id;
    queue_.pop_front();
  }
  return {std::move(data), finished};
}

std::optional<Bytes> BroadcastReceiver::take(const MacAddress& sender, wire::BootTag boot,
                                             const wire::BroadcastData& data, Time now) {
  if (data.total > largest_packet_) return std::nullopt;
  const Reassembly::Key key{sender, boot, Reassembly::kBroadcast, data.packet};
  auto found = packets_.find(key);
  if (found == packets_.end()) {
    if (!reassembly_.admit(key, data.total, false, now)) return std::nullopt;
    if (packets_.size() >= kMostPackets) {
      drop(std::min_element(packets_.begin(), packets_.end(), [](const auto& a, const auto& b) {
        return a.second.last_segment < b.second.last_segment;
      }));
    }
    found = packets_.emplace(key, Incoming{Assembly(data.total, data.segment_size), now}).first;
  }
  Incoming& packet = found->second;
  if (!packet.assembly.matches(data.total, data.segment_size)) return std::nullopt;
  packet.last_segment = now;
  if (!packet.assembly.take(data.index, data.octets)) return std::nullopt;
  reassembly_.progress(key, data.octets.size(), now);
  if (!packet.assembly.complete()) return std::nullopt;
  reassembly_.release(key);
  return packet.assembly.take_image();
}

void BroadcastReceiver::drop(std::map<Reassembly::Key, Incoming>::iterator packet) {
  reassembly_.release(packet->first);
  packets_.erase(packet);
}

void BroadcastReceiver::expire(Time now) {
  for (auto iterator = packets_.begin(); iterator != packets_.end();) {
    const auto packet = iterator++;
    if (now - packet->second.last_segment >= kPatience) drop(packet);
  }
}

}  // namespace adhoc_communication::transport
