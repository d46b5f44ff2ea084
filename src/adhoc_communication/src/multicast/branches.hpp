// The branches of the trees that this robot is part of: its place in each, and the packets on it.
#pragma once

#include <array>
#include <vector>

#include "address_map.hpp"
#include "identity.hpp"
#include "multicast/transfer.hpp"
#include "multicast/tree.hpp"
#include "transport/hop_sender.hpp"
#include "transport/round_trip.hpp"

namespace adhoc_communication::multicast {

struct Branch {
  Tree tree;
  std::array<GroupStream, transport::kPriorities> streams;
  bool busy = true;  ///< something came for it; otherwise nothing is due
  transport::RoundTrip round_trip{std::chrono::milliseconds(30), std::chrono::milliseconds(10),
                                  std::chrono::milliseconds(200)};  ///< to the children
  // The rhythm of the frames from upstream.
  std::uint64_t last_counter = 0;
  Time last_arrival{0};
  std::uint64_t measured_counter = 0;
  Time spacing{0};

  /// Counters and rounds of the former upstream neighbour mean nothing to a new one.
  void forget_rhythm();
  /// Its children, or the members behind them, are others than before; `anew`: so is the tree.
  void children_changed(bool anew, Time now);
  void lose_place(Time now);
  bool has_frame(std::size_t priority) const;
  /// Frames wait, of whatever priority, be the branch busy or not.
  bool sends() const;
  /// The next report or question; max: nothing is due until something comes.
  Time next_deadline() const;
};

/// By root.
class Branches {
 public:
  static constexpr std::size_t kMostTrees = 1024;  ///< the one idle longest makes room
  static constexpr Time kIdleTree = std::chrono::seconds(60);
  /// Of a robot that has had children. They count on it for kIdleTree after the last frame from it, and that may come
  /// kIdleTree after the last one to it.
  static constexpr Time kBoundTree = std::chrono::seconds(180);

  explicit Branches(const Identity& self) : self_(self) {}

  bool is_root(const MacAddress& root) const { return root == self_.address; }
  /// For what has come about this tree; nothing if this robot is not part of it.
  Branch* find(const MacAddress& root, wire::BootTag boot);
  /// That of this run of the root; the branch of a former run is forgotten.
  Branch& of(const MacAddress& root, wire::BootTag boot, Time now);
  /// The tree of which this robot is the root; nothing before its first packet.
  Branch* own();
  const AddressMap<Branch>& all() const { return branches_; }
  AddressMap<Branch>& all() { return branches_; }
  /// Forgets trees that have been idle, and places to which nothing comes from above. The numbers of the own packets go
  /// on for ever.
  void expire(Time now);

 private:
  const Identity& self_;
  AddressMap<Branch> branches_;
};

}  // namespace adhoc_communication::multicast
