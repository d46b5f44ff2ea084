// Room for packets that are being put together, whatever carries them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "transport/room_share.hpp"

namespace adhoc_communication::transport {

/// A whole packet gets its room with its first segment, so whatever was admitted can be finished; who makes room when
/// there is none stands at RoomShare. Little packets have a share for themselves and take part in the other one, too,
/// so that large ones never keep them out. A newcomer without room is told.
class Reassembly {
 public:
  static constexpr std::size_t kPackets = 4;         ///< of the largest size, together
  static constexpr std::size_t kLittlePackets = 16;  ///< of the little ones, in their share
  /// Octets of a little packet, at most; a kLittlePackets-th of the largest size where that is less.
  static constexpr std::size_t kLittle = 64'000;
  static constexpr std::size_t kOverhead = 256;  ///< octets that a packet takes besides its own

  /// What carries a packet: a stream by its number, or one of these.
  static constexpr std::uint8_t kBroadcast = 4;
  static constexpr std::uint8_t kGroup = 8;  ///< plus the number of the stream
  using Key = PacketKey;

  explicit Reassembly(std::size_t largest_packet)
      : whole_(kPackets * (largest_packet + kOverhead)),
        most_little_(std::min(kLittle, largest_packet / kLittlePackets)),
        little_(kLittlePackets * (most_little_ + kOverhead)) {}

  /// Room for a packet of `octets`; `next`: the others of its stream wait for it. False if there is none.
  bool admit(const Key& key, std::size_t octets, bool next, Time now);
  /// A segment was of use.
  void progress(const Key& key, std::size_t octets, Time now);
  /// No segment of it came lately, or too few did.
  bool stalled(const Key& key, Time now) const;
  /// The packet is complete and still needed here.
  void keep(const Key& key, Time now);
  /// The packet is complete, and nothing is left to do with it: it stays as long as nobody needs its room.
  void spare(const Key& key);
  void release(const Key& key);
  /// Packets that had to make room; whoever put them together has to forget them.
  std::vector<Key> take_evicted();

  /// Octets that packets take, by what carries them.
  struct Fill {
    std::size_t streams = 0;
    std::size_t groups = 0;
    std::size_t complete_groups = 0;
  };
  Fill fill() const;

  std::size_t packets() const { return whole_.places().size() + little_.places().size(); }
  /// For packets of all sizes.
  const RoomShare& whole() const { return whole_; }
  /// For little ones.
  const RoomShare& little() const { return little_; }

 private:
  RoomShare::Place* find(const Key& key);

  RoomShare whole_;
  std::size_t most_little_;
  RoomShare little_;
  std::vector<Key> evicted_;
};

}  // namespace adhoc_communication::transport
