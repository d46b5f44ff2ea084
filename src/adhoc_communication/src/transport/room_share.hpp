// A share of the room for packets that are being put together: who has a place in it, and who makes room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "wire/octets.hpp"

namespace adhoc_communication::transport {

struct PacketKey {
  MacAddress source{};
  wire::BootTag boot = 0;
  std::uint8_t carrier = 0;
  std::uint32_t packet = 0;

  friend bool operator<(const PacketKey& a, const PacketKey& b) {
    return std::tie(a.source, a.boot, a.carrier, a.packet) < std::tie(b.source, b.boot, b.carrier, b.packet);
  }
};

/// Half of it at most is for one source. When there is no room, these make it, in this order: spare packets, the oldest
/// first; packets that have stalled, the youngest first; for a packet that all later ones of its stream wait for,
/// these; and the youngest packets of the source that holds most, as long as it still holds as much as the newcomer's
/// source does then. So nobody loses the oldest packet of his that goes on.
class RoomShare {
 public:
  static constexpr Time kStalled = std::chrono::seconds(2);  ///< without a new segment
  static constexpr std::size_t kLeastRate = 8000;  ///< octets per second; a packet that brings less has stalled, too
  /// So has a large one that would take longer in all, at the rate at which it comes.
  static constexpr Time kLongestStay = std::chrono::seconds(100);

  explicit RoomShare(std::size_t most) : most_(most) {}

  /// Takes room for a packet of that cost where nobody has to make it.
  bool take(const PacketKey& key, std::size_t cost, Time now);
  /// The same where others have to; they are added to `evicted`. `next`: the others of its stream wait for it.
  bool take_from_others(const PacketKey& key, std::size_t cost, bool next, Time now, std::vector<PacketKey>& evicted);

  enum class Use {
    kFills,
    kKept,   ///< complete, and still of use here: it stalls when nothing of it is passed on
    kSpare,  ///< complete, and nothing is left to do with it: it counts for nobody
  };
  struct Place {
    std::size_t cost = 0;
    std::size_t filled = 0;
    std::uint64_t order = 0;  ///< of admission
    Time admitted{0};
    Time last{0};
    Use use = Use::kFills;
  };
  using Places = std::map<PacketKey, Place>;

  Place* find(const PacketKey& key);
  /// No segment of it came lately, or less than kLeastRate; so it is with a packet that has no place.
  bool stalled(const PacketKey& key, Time now) const;
  void release(const PacketKey& key);
  const Places& places() const { return places_; }
  std::size_t taken() const { return taken_; }
  std::size_t most() const { return most_; }

 private:
  /// Those that are to make room.
  struct Leaving {
    std::map<std::uint64_t, Places::const_iterator> places;  ///< by their order
    std::size_t octets = 0;
  };
  template <typename Predicate>
  void add(Leaving& leaving, std::size_t octets, bool oldest_first, Predicate candidate) const;
  void add_of_greediest(Leaving& leaving, std::size_t octets, const MacAddress& newcomer, std::size_t own) const;
  std::size_t held_by(const MacAddress& source) const;

  std::size_t most_;
  std::size_t taken_ = 0;
  std::uint64_t admitted_ = 0;
  Places places_;
};

}  // namespace adhoc_communication::transport
