// Group packets that everybody who hears them may pass on: who has sent each so far, and what this robot sends of it.
//
// A packet of one frame for most of the team costs less that way than a tree, which moving robots break as fast as it
// is built. Who believes that all his neighbours have got it from others stays silent (neighbour elimination); who
// does not hear it from a neighbour afterwards sends it again.
#pragma once

#include <array>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <vector>

#include "identity.hpp"
#include "multicast/group_frame.hpp"
#include "random.hpp"
#include "routing/neighbors.hpp"
#include "transport/priorities.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

/// Of at most kMostPackets it is known that they were here; the oldest makes room, and is not passed on any more.
class Flooding {
 public:
  static constexpr std::size_t kMostPackets = 1024;
  static constexpr Time kJitter = std::chrono::milliseconds(10);  ///< before a packet is passed on
  static constexpr Time kEcho = std::chrono::milliseconds(40);    ///< by then a neighbour has passed it on
  static constexpr int kMostSends = 3;
  static constexpr double kDoubt = 0.1;  ///< probability that a neighbour has not got it, which may be left at that

  Flooding(const Identity& self, const routing::Neighbors& neighbors, Random& random)
      : self_(self), neighbors_(neighbors), random_(random) {}

  /// An own packet.
  void originate(wire::GroupData data, Time now) { add({}, std::move(data), Time(0), now); }
  /// One that came from `from`, who has sent it by now.
  void take(const MacAddress& from, const wire::GroupData& data, Time now);
  /// One that came by itself: robots near this one may lack it as well.
  void take_copy(wire::GroupData data, Time now);
  /// The neighbour with the best link of those that sent the latest packet of that run of the root before this robot
  /// decided about it. Each has sent it before whoever chooses it, so that nothing goes in circles.
  std::optional<MacAddress> upstream(const MacAddress& root, wire::BootTag boot) const;

  /// Decides about packets that are due; their frames are ready then.
  void poll(Time now);
  Time next_deadline() const { return due_.empty() ? Time::max() : due_.begin()->first; }
  bool has_frame(std::uint8_t priority) const { return !ready_[priority].empty(); }
  /// From whom the packets came first that are ready; all zero for own ones.
  void add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const;
  std::optional<GroupFrame> next(std::uint8_t priority, const MacAddress& previous_hop, Time now);

  std::size_t packets() const { return packets_.size(); }

 private:
  using Key = std::tuple<MacAddress, wire::BootTag, std::uint8_t, std::uint32_t>;
  struct Packet {
    wire::GroupData data;  ///< as this robot sends it; without octets once that is over
    MacAddress first{};    ///< from whom it came first; all zero if it is an own one
    std::set<MacAddress> senders;
    int sends = 0;
    std::optional<Time> due;  ///< when it is decided whether to send it
  };
  struct Upstream {
    MacAddress neighbor{};
    Key packet{};
    Time since{0};
  };

  static Key key_of(const wire::GroupData& data) { return {data.root, data.root_boot, data.stream, data.packet}; }
  void add(const MacAddress& from, wire::GroupData data, Time jitter, Time now);
  void make_room();
  void decide_at(const Key& key, Packet& packet, Time due);
  void forget_due(const Key& key, Packet& packet);
  void note_upstream(const Key& packet, const MacAddress& from, Time now);
  void prefer_upstream(const Key& packet, const MacAddress& from, Time now);
  bool all_have(const Packet& packet, Time now) const;
  double missed(const routing::Neighbor& neighbor, const Packet& packet, Time now) const;

  const Identity& self_;
  const routing::Neighbors& neighbors_;
  Random& random_;
  std::map<Key, Packet> packets_;
  std::deque<Key> oldest_;  ///< first
  std::set<std::pair<Time, Key>> due_;
  std::array<std::deque<Key>, transport::kPriorities> ready_;
  std::map<MacAddress, Upstream> upstream_;  ///< by root
};

}  // namespace adhoc_communication::multicast
