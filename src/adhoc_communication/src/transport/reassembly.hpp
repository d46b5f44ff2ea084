// Room for packets that are being put together, whatever carries them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "wire/octets.hpp"

namespace adhoc_communication::transport {

/// A whole packet gets its room with its first segment, so whatever was admitted can be finished. When there is no
/// room, the youngest of those that have stalled make it; others go on, and the newcomer is told. A packet that all
/// later ones of its stream wait for takes the room of these.
class Reassembly {
 public:
  static constexpr std::size_t kPackets = 4;                 ///< of the largest size, together
  static constexpr std::size_t kOfASource = 2;               ///< of these, for one robot
  static constexpr std::size_t kOverhead = 256;              ///< octets that a packet takes besides its own
  static constexpr Time kStalled = std::chrono::seconds(2);  ///< without a new segment
  static constexpr std::size_t kLeastRate = 8000;  ///< octets per second; a packet that brings less has stalled, too

  /// What carries a packet: a stream by its number, or one of these.
  static constexpr std::uint8_t kBroadcast = 4;
  static constexpr std::uint8_t kGroup = 8;  ///< plus the number of the stream
  struct Key {
    MacAddress source{};
    wire::BootTag boot = 0;
    std::uint8_t carrier = 0;
    std::uint32_t packet = 0;

    friend bool operator<(const Key& a, const Key& b) {
      return std::tie(a.source, a.boot, a.carrier, a.packet) < std::tie(b.source, b.boot, b.carrier, b.packet);
    }
  };

  explicit Reassembly(std::size_t largest_packet)
      : most_(kPackets * (largest_packet + kOverhead)), most_of_a_source_(kOfASource * (largest_packet + kOverhead)) {}

  /// Room for a packet of `octets`; `next`: the others of its stream wait for it. False if there is none.
  bool admit(const Key& key, std::size_t octets, bool next, Time now);
  /// A segment was of use.
  void progress(const Key& key, std::size_t octets, Time now);
  bool stalled(const Key& key, Time now) const;
  /// The packet is complete and still needed here: it keeps its room, and its source may begin others.
  void keep(const Key& key);
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

  std::size_t packets() const { return places_.size(); }
  std::size_t octets() const { return taken_; }
  std::size_t most() const { return most_; }

 private:
  struct Place {
    std::size_t cost = 0;
    std::size_t filled = 0;
    std::uint64_t order = 0;  ///< of admission
    Time admitted{0};
    Time last{0};
    bool kept = false;
  };
  using Places = std::map<Key, Place>;

  static bool has_stalled(const Place& place, Time now);
  std::size_t taken_by(const MacAddress& source) const;
  template <typename Predicate>
  std::vector<Key> youngest(std::size_t cost, Predicate candidate) const;
  std::vector<Key> later_ones(const Key& key, std::size_t cost) const;
  void evict(const std::vector<Key>& keys);

  std::size_t most_;
  std::size_t most_of_a_source_;
  std::size_t taken_ = 0;
  std::uint64_t admitted_ = 0;
  Places places_;
  std::vector<Key> evicted_;
};

}  // namespace adhoc_communication::transport
