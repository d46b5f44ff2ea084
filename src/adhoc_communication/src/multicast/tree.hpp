// This robot's place in the tree of one root: who is above, who is below, and which members are reached through whom.
//
// The root hands every member to the next hop of its unicast route, which does the same (MACT of MAODV, as part of a
// source-rooted tree). Within one epoch a robot accepts one upstream neighbour and no other, so the enabled links form
// a tree at any instant; what cannot be attached is refused, and the root builds the tree anew with a greater epoch.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

/// Exclusive or of these tells two sets of members apart.
std::uint32_t digest(const MacAddress& member);

struct Tree {
  wire::BootTag boot = 0;
  std::uint32_t epoch = 0;
  std::optional<MacAddress> upstream;
  bool member = false;                                  ///< this robot itself belongs to the group
  std::map<MacAddress, std::set<MacAddress>> children;  ///< members by the neighbour through which they are reached
  std::set<MacAddress> unrouted;                        ///< members without route so far
  /// By member: the children that have refused it in this epoch.
  std::map<MacAddress, std::set<MacAddress>> refused;
  std::map<MacAddress, Time> activated_again;  ///< children that did not know their place, and when last
  Time last_used{0};

  std::set<MacAddress> child_addresses() const;
  /// The children, each with the digest of the members behind it.
  std::map<MacAddress, std::uint32_t> coverages() const;
  /// Digest of the members behind one child.
  std::uint32_t coverage(const MacAddress& child) const;
  /// Digest of all members that this robot has taken over.
  std::uint32_t own_coverage(const MacAddress& self) const;
  bool holds(const MacAddress& member) const;
  /// Takes the member away from whoever has it. Returns the child that had it.
  std::optional<MacAddress> remove(const MacAddress& member);
  /// The children behind which these members are.
  std::set<MacAddress> ways_to(const std::set<MacAddress>& members) const;
  /// Who was attached `before` stays where it was. Returns the other members.
  std::set<MacAddress> keep_attached(const std::map<MacAddress, std::set<MacAddress>>& before,
                                     std::set<MacAddress> members);
  /// Those to which other members are entrusted than `before`, and those pruned; all if the tree is built anew.
  std::set<MacAddress> changed_children(const std::map<MacAddress, std::set<MacAddress>>& before, bool anew) const;
  /// Of who is no child any more it does not matter when it was activated again.
  void forget_former_children();
  /// Of who is not to be reached any more it does not matter who has refused it.
  void forget_refusals_of_others(const std::set<MacAddress>& members);
  /// The most entries that any of its tables has; kMostMembersOfActivation at most, since the members are no more.
  std::size_t largest_table() const;
  /// With nobody behind it, this robot may get another place in the tree of the same epoch.
  void leave();
  /// At the root: nobody has a place yet.
  void next_epoch();
};

}  // namespace adhoc_communication::multicast
