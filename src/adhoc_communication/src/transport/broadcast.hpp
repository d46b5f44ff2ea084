// Packets for everybody in range: cut into segments, put together where all of them arrive, never repeated.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "transport/assembly.hpp"
#include "transport/packet_image.hpp"
#include "transport/priorities.hpp"
#include "transport/reassembly.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

class BroadcastSender {
 public:
  void add(SendId id, Image image, std::uint16_t segment_size) {
    // Receivers tell packets by their number alone, so it has to be unique among all priorities.
    queue_.push_back({id, static_cast<std::uint32_t>(id), std::move(image), segment_size, 0});
  }
  /// Puts another packet in the place of one not begun yet. False if there is no such packet.
  bool replace(SendId former, SendId id, const Image& image, std::uint16_t segment_size);
  void drop(SendId id);
  bool has_segment() const { return !queue_.empty(); }
  /// The next segment, and the packet if this was its last one.
  std::pair<wire::BroadcastData, std::optional<SendId>> next_segment();

 private:
  struct Outgoing {
    SendId id;
    std::uint32_t number;
    Image image;
    std::uint16_t segment_size;
    std::uint32_t next_index;
  };
  std::deque<Outgoing>::iterator find(SendId id);

  std::deque<Outgoing> queue_;
};

using BroadcastSenders = std::array<BroadcastSender, kPriorities>;

/// At most kMostPackets are being put together; the one without news for longest makes room.
class BroadcastReceiver {
 public:
  static constexpr std::size_t kMostPackets = 64;
  static constexpr Time kPatience = std::chrono::seconds(2);

  BroadcastReceiver(std::size_t largest_packet, Reassembly& reassembly)
      : largest_packet_(largest_packet), reassembly_(reassembly) {}

  /// The packet that this segment completes.
  std::optional<Bytes> take(const MacAddress& sender, wire::BootTag boot, const wire::BroadcastData& data, Time now);
  /// It had to make room.
  void evicted(const Reassembly::Key& key) { packets_.erase(key); }
  void expire(Time now);
  std::size_t packets() const { return packets_.size(); }

 private:
  struct Incoming {
    Assembly assembly;
    Time last_segment{0};
  };

  void drop(std::map<Reassembly::Key, Incoming>::iterator packet);

  std::size_t largest_packet_;
  Reassembly& reassembly_;
  std::map<Reassembly::Key, Incoming> packets_;  ///< also complete ones for a while, to drop repetitions
};

}  // namespace adhoc_communication::transport
