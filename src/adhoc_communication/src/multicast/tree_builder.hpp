// How trees grow, lose branches and are built anew.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "multicast/branches.hpp"
#include "outbox.hpp"
#include "routing/router.hpp"

namespace adhoc_communication::multicast {

/// Members that the own tree does not reach. `final`: there is no way to them at all.
struct LeftOver {
  std::set<MacAddress> members;
  std::string reason;
  bool final = false;
};

/// Branches whose children are others than before; `anew`: so is the tree.
struct ChangedBranch {
  MacAddress root{};
  bool anew = false;
};

/// Tells neighbours their places; what follows from it for the packets is taken by whoever calls.
class TreeBuilder {
 public:
  static constexpr Time kActivationInterval = std::chrono::milliseconds(50);
  static constexpr std::size_t kMostChildrenTried = 2;  ///< for one member in one epoch

  TreeBuilder(const Identity& self, const routing::Neighbors& neighbors, routing::Router& router, Outbox& outbox,
              Branches& branches)
      : self_(self), neighbors_(neighbors), router_(router), outbox_(outbox), branches_(branches) {}

  // At the root.
  void add_members(Tree& own, const std::set<MacAddress>& members, Time now);
  /// All of them in a tree of a new epoch.
  void build_anew(Tree& own, const std::set<MacAddress>& members, Time now);
  void prune(Tree& own, const MacAddress& member);

  // At every robot.
  /// `takes_part`: this run has joined the group, or is about to. A former run may have been a member.
  void on_activation(const Run& from, const wire::GroupActivation& activation, bool takes_part, Time now);
  void on_refusal(const MacAddress& from, const wire::GroupRefusal& refusal, Time now);
  /// A child that knows another tree has missed an activation, or its refusal was lost.
  void activate_again(const MacAddress& root, Tree& tree, const MacAddress& child, Time now);
  /// These children are of no use: what is behind them goes back upstream.
  void give_up(const MacAddress& root, Tree& tree, const std::vector<MacAddress>& children);
  /// The neighbour is gone, or has restarted.
  void link_lost(const MacAddress& neighbor);
  /// First sign of a neighbour, or of a new run of it.
  void appeared(const Run& neighbor);
  /// A search for a route has failed; `nearby`: it looked only there.
  void unreachable(const MacAddress& member, const std::string& reason, bool nearby);
  /// Members whose routes have been found meanwhile, or cannot be looked for.
  void attach_routed(Time now);

  std::vector<ChangedBranch> take_changed() { return std::exchange(changed_, {}); }
  std::vector<LeftOver> take_left_over() { return std::exchange(left_over_, {}); }

 private:
  using Children = std::map<MacAddress, std::set<MacAddress>>;

  bool look_for(const MacAddress& root, const MacAddress& member, Time now);
  std::set<MacAddress> attach(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members, Time now);
  void shorten(Tree& tree, const std::set<MacAddress>& members, Time now) const;
  void activate(const MacAddress& root, const Tree& tree, const std::set<MacAddress>& children);
  void turn_down(const MacAddress& from, const wire::GroupActivation& activation);
  void refuse(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members);
  std::set<MacAddress> attach_elsewhere(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members,
                                        const MacAddress& refuser, Time now);
  const MacAddress* elsewhere(const MacAddress& root, const Tree& tree, const MacAddress& member,
                              const MacAddress& refuser, Time now) const;
  bool hears(const MacAddress& neighbor, const MacAddress& robot, Time now) const;

  const Identity& self_;
  const routing::Neighbors& neighbors_;
  routing::Router& router_;
  Outbox& outbox_;
  Branches& branches_;
  std::vector<ChangedBranch> changed_;
  std::vector<LeftOver> left_over_;
};

}  // namespace adhoc_communication::multicast
