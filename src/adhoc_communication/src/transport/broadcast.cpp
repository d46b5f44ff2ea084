#include "transport/broadcast.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

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
  const Key key{sender, boot, data.packet};
  auto found = assemblies_.find(key);
  if (found == assemblies_.end()) {
    if (assemblies_.size() >= kMostPackets) {
      drop(std::min_element(assemblies_.begin(), assemblies_.end(), [](const auto& a, const auto& b) {
        return a.second.last_segment < b.second.last_segment;
      }));
    }
    Assembly assembly;
    assembly.total = data.total;
    assembly.segment_size = data.segment_size;
    assembly.missing = (data.total + data.segment_size - 1) / data.segment_size;
    found = assemblies_.emplace(key, std::move(assembly)).first;
  }
  Assembly& assembly = found->second;
  if (assembly.total != data.total || assembly.segment_size != data.segment_size || assembly.missing == 0) {
    return std::nullopt;
  }
  assembly.last_segment = now;
  if (data.index < assembly.present.size() && assembly.present[data.index]) return std::nullopt;
  // Segments go out in order: one far beyond those that arrived is forged, or the packet is lost anyway.
  if (data.index > assembly.present.size() + StreamReceiver::kSegmentsAhead) return std::nullopt;
  const std::size_t begin = std::size_t{data.index} * data.segment_size;
  const std::size_t end = begin + data.octets.size();
  if (end > assembly.octets.size()) {
    if (!budget_.take(end - assembly.octets.size())) return std::nullopt;
    assembly.octets.resize(end);
  }
  if (data.index >= assembly.present.size()) assembly.present.resize(data.index + 1);
  assembly.present[data.index] = true;
  std::copy(data.octets.begin(), data.octets.end(), assembly.octets.begin() + static_cast<std::ptrdiff_t>(begin));
  if (--assembly.missing > 0) return std::nullopt;
  budget_.give_back(assembly.octets.size());
  return std::exchange(assembly.octets, {});
}

void BroadcastReceiver::drop(std::map<Key, Assembly>::iterator assembly) {
  budget_.give_back(assembly->second.octets.size());
  assemblies_.erase(assembly);
}

void BroadcastReceiver::expire(Time now) {
  for (auto iterator = assemblies_.begin(); iterator != assemblies_.end();) {
    const auto assembly = iterator++;
    if (now - assembly->second.last_segment >= kPatience) drop(assembly);
  }
}

}  // namespace adhoc_communication::transport
