// This robot's place in the tree of one root: who is above, who is below, and which members are reached through whom.
//
// The root hands every member to the next hop of its unicast route, which does the same (MACT of MAODV, as part of a
// source-rooted tree). What cannot be attached is refused, and the root builds the tree anew with a greater epoch.
//
// Within one epoch a robot has one upstream neighbour at a time, and from its first child on that one or none: a former
// child may still count on it, without any way to know better. Who is so bound was bound later than whoever is above,
// so the links lead nobody back to himself, whatever is lost, late or repeated.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

/// Exclusive or of these tells two sets of members apart.
std::uint32_t digest(const MacAddress& member);

/// A robot from its start to its end.
struct Run {
  MacAddress robot{};
  wire::BootTag boot = 0;
};

inline bool operator==(const Run& a, const Run& b) { return a.robot == b.robot && a.boot == b.boot; }

struct Tree {
  wire::BootTag boot = 0;
  std::uint32_t epoch = 0;
  std::optional<MacAddress> upstream;
  Run above;  ///< the upstream neighbour, or the last one
  Time heard_above{0};
  bool bound = false;   ///< has had children in this epoch: its place is below that run, or nowhere
  bool member = false;  ///< this robot itself belongs to the group
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
  /// Whether that run may be its upstream neighbour in this epoch.
  bool may_be_below(const Run& run) const;
  void take_place(const Run& below, std::uint32_t in_epoch, Time now);
  void entrust(const MacAddress& member, const MacAddress& child);
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
  /// With nobody behind it, this robot gives up its place.
  void leave();
  /// From a run that another has followed nothing comes any more, whoever is behind this robot.
  void appeared(const Run& neighbor);
  /// Nobody is behind this robot any more.
  void lose_place();
  /// At the root: nobody has a place yet.
  void next_epoch();
};

}  // namespace adhoc_communication::multicast
