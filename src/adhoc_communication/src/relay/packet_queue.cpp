#include "relay/packet_queue.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace adhoc_communication {
namespace {

constexpr std::size_t kPacketCost = 1000;  ///< octets; of a packet besides its own

std::size_t unpacked_size(const PacketReceived& packet) {
  return std::max<std::size_t>(packet.payload.size(), packet.unpacked_size);
}

}  // namespace

std::vector<PacketReceived> PacketQueue::add(PacketReceived packet) {
  const std::string name = packet.source;
  const auto source = sources_.try_emplace(name).first;
  Waiting& waiting = source->second;
  ++packets_;
  octets_ += packet.payload.size();
  waiting.octets += packet.payload.size();
  waiting.unpacked += unpacked_size(packet);
  waiting.packets.push_back(std::move(packet));
  std::vector<PacketReceived> dropped;
  if (waiting.packets.size() > 1 && waiting.unpacked > kMostUnpackedOfASource) dropped.push_back(remove(source, true));
  while (packets_ > kMostPackets || (packets_ > 1 && octets_ > kMostOctets)) {
    const auto most = keeps_most();
    dropped.push_back(remove(most == sources_.end() ? sources_.find(name) : most, true));
  }
  return dropped;
}

/// Of what there is too much of; the end if each robot has one packet.
PacketQueue::Sources::iterator PacketQueue::keeps_most() {
  const auto kept = [too_many = packets_ > kMostPackets](const Waiting& waiting) {
    if (waiting.packets.size() < 2) return std::size_t{0};
    return too_many ? waiting.packets.size() : waiting.octets;
  };
  const auto most = std::max_element(sources_.begin(), sources_.end(),
                                     [&](const auto& a, const auto& b) { return kept(a.second) < kept(b.second); });
  return kept(most->second) == 0 ? sources_.end() : most;
}

PacketReceived PacketQueue::take() {
  std::vector<std::string> sources;
  for (const auto& [source, waiting] : sources_) sources.push_back(source);
  turns_.sort(sources);
  const std::string& next = sources.front();
  PacketReceived packet = remove(sources_.find(next), false);
  turns_.charge(next, unpacked_size(packet) + kPacketCost);
  return packet;
}

PacketReceived PacketQueue::remove(Sources::iterator source, bool latest) {
  Waiting& waiting = source->second;
  PacketReceived packet = std::move(latest ? waiting.packets.back() : waiting.packets.front());
  latest ? waiting.packets.pop_back() : waiting.packets.pop_front();
  --packets_;
  octets_ -= packet.payload.size();
  waiting.octets -= packet.payload.size();
  waiting.unpacked -= unpacked_size(packet);
  if (waiting.packets.empty()) sources_.erase(source);
  return packet;
}

}  // namespace adhoc_communication
