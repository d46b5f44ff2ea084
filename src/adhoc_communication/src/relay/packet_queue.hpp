// Packets of other robots that wait to be published. No ROS, no thread, no clock.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "air/fair_share.hpp"

namespace adhoc_communication {

/// Robots take turns by what their packets unpack to, for that is what these cost; those of one robot stay in order.
/// Without room, the robot that keeps most loses its latest packet; while each has one, a new one is dropped.
class PacketQueue {
 public:
  static constexpr std::size_t kMostPackets = 1000;
  static constexpr std::size_t kMostOctets = 16'000'000;             ///< as they came, if it is more than one packet
  static constexpr std::size_t kMostUnpackedOfASource = 32'000'000;  ///< likewise

  /// The packets that were dropped for want of room, be it this one.
  std::vector<PacketReceived> add(PacketReceived packet);
  /// The next one; there has to be one.
  PacketReceived take();

  bool empty() const { return packets_ == 0; }
  std::size_t size() const { return packets_; }
  std::size_t octets() const { return octets_; }

 private:
  struct Waiting {
    std::deque<PacketReceived> packets;
    std::size_t octets = 0;
    std::size_t unpacked = 0;
  };
  using Sources = std::map<std::string, Waiting>;

  Sources::iterator keeps_most();
  PacketReceived remove(Sources::iterator source, bool latest);

  Sources sources_;
  std::size_t packets_ = 0;
  std::size_t octets_ = 0;
  air::FairShare<std::string> turns_;
};

}  // namespace adhoc_communication
