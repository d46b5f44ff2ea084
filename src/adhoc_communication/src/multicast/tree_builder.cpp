#include "multicast/tree_builder.hpp"

#include <algorithm>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::multicast {

using wire::FrameType;

/// The root looks everywhere for its members. For a relay that knows no way, another robot is probably the better
/// place; it looks near by.
bool TreeBuilder::look_for(const MacAddress& root, const MacAddress& member, Time now) {
  if (!branches_.is_root(root)) return router_.search_nearby(member, now);
  router_.search({member, {}}, now);
  return true;
}

/// Gives the members to the next hops of their routes; returns those that lead back to where they came from, and those
/// that cannot be looked for.
std::set<MacAddress> TreeBuilder::attach(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members,
                                         Time now) {
  std::set<MacAddress> refused;
  for (const MacAddress& member : members) {
    const routing::Route* route = router_.route_to(member, now);
    if (route == nullptr && look_for(root, member, now)) {
      tree.unrouted.insert(member);
    } else if (route == nullptr) {
      tree.unrouted.erase(member);
      refused.insert(member);
    } else if (tree.upstream && route->next_hop == *tree.upstream) {
      tree.unrouted.erase(member);
      refused.insert(member);
    } else {
      tree.unrouted.erase(member);
      tree.entrust(member, route->next_hop);
      router_.used(root, member, tree.upstream.value_or(self_.address), now);
    }
  }
  shorten(tree, members, now);
  return refused;
}

/// A frame for all children is sent as often as the worst of their links takes, and once more by each relay: a member
/// in range is a child of its own though packets for it alone go round, unless its link is worse than both together.
void TreeBuilder::shorten(Tree& tree, const std::set<MacAddress>& members, Time now) const {
  routing::Cost worst = 0;
  for (const auto& [child, behind] : tree.children) worst = std::max(worst, neighbors_.cost(child));
  for (const MacAddress& member : members) {
    const routing::Route* route = router_.route_to(member, now);
    if (route == nullptr || route->next_hop == member || !neighbors_.two_way(member, now)) continue;
    const auto relay = tree.children.find(route->next_hop);
    if (relay == tree.children.end() || relay->second.count(member) == 0) continue;
    const auto beyond = std::max<int>(route->cost - neighbors_.cost(relay->first), routing::kPerfectHop);
    if (neighbors_.cost(member) >= worst + beyond) continue;
    relay->second.erase(member);
    if (relay->second.empty()) tree.children.erase(relay);
    tree.entrust(member, member);
  }
}

void TreeBuilder::attach_routed(Time now) {
  for (auto& [root, branch] : branches_.all()) {
    Tree& tree = branch.tree;
    std::set<MacAddress> routed;
    for (const MacAddress& member : tree.unrouted) {
      if (router_.route_to(member, now) != nullptr || !look_for(root, member, now)) routed.insert(member);
    }
    if (routed.empty()) continue;
    refuse(root, tree, attach(root, tree, routed, now));
    activate(root, tree, tree.ways_to(routed));
    changed_.push_back({root, false});
  }
}

void TreeBuilder::add_members(Tree& own, const std::set<MacAddress>& members, Time now) {
  std::set<MacAddress> newcomers;
  for (const MacAddress& member : members) {
    if (own.holds(member)) continue;
    newcomers.insert(member);
    own.refused.erase(member);
  }
  attach(self_.address, own, newcomers, now);
  activate(self_.address, own, own.ways_to(newcomers));
  changed_.push_back({self_.address, false});
}

void TreeBuilder::build_anew(Tree& own, const std::set<MacAddress>& members, Time now) {
  own.next_epoch();
  attach(self_.address, own, members, now);
  activate(self_.address, own, own.child_addresses());
  changed_.push_back({self_.address, true});
}

void TreeBuilder::prune(Tree& own, const MacAddress& member) {
  own.refused.erase(member);
  const auto child = own.remove(member);
  if (!child) return;
  activate(self_.address, own, {*child});
  if (own.children[*child].empty()) own.children.erase(*child);
  changed_.push_back({self_.address, false});
}

void TreeBuilder::activate(const MacAddress& root, const Tree& tree, const std::set<MacAddress>& children) {
  for (const MacAddress& child : children) {
    wire::GroupActivation activation{root, tree.boot, tree.epoch, {}};
    if (const auto found = tree.children.find(child); found != tree.children.end()) {
      activation.members.assign(found->second.begin(), found->second.end());
    }
    outbox_.unicast(child, FrameType::kGroupActivation, to_bytes(activation));
  }
}

void TreeBuilder::activate_again(const MacAddress& root, Tree& tree, const MacAddress& child, Time now) {
  tree.forget_former_children();
  const auto [last, first] = tree.activated_again.emplace(child, now);
  if (!first && now - last->second < kActivationInterval) return;
  last->second = now;
  activate(root, tree, {child});
}

void TreeBuilder::on_activation(const Run& from, const wire::GroupActivation& activation, bool takes_part, Time now) {
  if (branches_.is_root(activation.root)) return;
  Branch& branch = branches_.of(activation.root, activation.root_boot, now);
  Tree& tree = branch.tree;
  tree.last_used = now;
  const bool anew = tree.epoch == 0 || routing::is_newer(activation.epoch, tree.epoch);
  const bool stays = activation.epoch == tree.epoch && tree.may_be_below(from);
  if (!anew && !stays) return turn_down(from.robot, activation);
  const Children before = std::exchange(tree.children, {});
  if (tree.upstream != from.robot) branch.forget_rhythm();
  tree.take_place(from, activation.epoch, now);
  tree.unrouted.clear();
  std::set<MacAddress> members(activation.members.begin(), activation.members.end());
  tree.forget_refusals_of_others(members);
  const bool asked = members.erase(self_.address) != 0;
  tree.member = asked && takes_part;
  if (!anew) members = tree.keep_attached(before, std::move(members));
  std::set<MacAddress> refused = attach(activation.root, tree, members, now);
  if (asked && !takes_part) refused.insert(self_.address);
  refuse(activation.root, tree, refused);
  activate(activation.root, tree, tree.changed_children(before, anew));
  if (!tree.member) tree.leave();
  changed_.push_back({activation.root, anew});
}

void TreeBuilder::turn_down(const MacAddress& from, const wire::GroupActivation& activation) {
  if (activation.members.empty()) return;
  const wire::GroupRefusal refusal{activation.root, activation.root_boot, activation.epoch, activation.members};
  outbox_.unicast(from, FrameType::kGroupRefusal, to_bytes(refusal));
}

/// Gives members back to whoever entrusted them to this robot.
void TreeBuilder::refuse(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members) {
  if (members.empty()) return;
  if (branches_.is_root(root)) return left_over_.push_back({members, "the tree does not reach it", false});
  if (!tree.upstream) return;
  outbox_.unicast(*tree.upstream, FrameType::kGroupRefusal,
                  to_bytes(wire::GroupRefusal{root, tree.boot, tree.epoch, {members.begin(), members.end()}}));
  if (!tree.member) tree.leave();
}

void TreeBuilder::on_refusal(const MacAddress& from, const wire::GroupRefusal& refusal, Time now) {
  Branch* branch = branches_.find(refusal.root, refusal.root_boot);
  if (branch == nullptr || refusal.epoch != branch->tree.epoch) return;
  Tree& tree = branch->tree;
  const auto child = tree.children.find(from);
  if (child == tree.children.end()) return;
  std::set<MacAddress> refused;
  for (const MacAddress& member : refusal.members) {
    if (child->second.erase(member) == 0) continue;
    refused.insert(member);
    tree.refused[member].insert(from);
  }
  if (child->second.empty()) tree.children.erase(child);
  refuse(refusal.root, tree, attach_elsewhere(refusal.root, tree, refused, from, now));
  changed_.push_back({refusal.root, false});
}

/// The routes to two members may meet at a robot, coming from different neighbours of which only one can be its
/// upstream neighbour. Perhaps another child reaches the other member, too. Returns those left over.
std::set<MacAddress> TreeBuilder::attach_elsewhere(const MacAddress& root, Tree& tree,
                                                   const std::set<MacAddress>& members, const MacAddress& refuser,
                                                   Time now) {
  std::set<MacAddress> left;
  std::set<MacAddress> concerned;
  for (const MacAddress& member : members) {
    const MacAddress* other = elsewhere(root, tree, member, refuser, now);
    if (other == nullptr) {
      left.insert(member);
    } else {
      tree.children.at(*other).insert(member);
      concerned.insert(*other);
    }
  }
  activate(root, tree, concerned);
  return left;
}

/// The child to try next for the member: one that hears it, or hears who has refused it. Otherwise any; but where the
/// refuser hears the member, it has its place elsewhere, and somebody above this robot knows where.
const MacAddress* TreeBuilder::elsewhere(const MacAddress& root, const Tree& tree, const MacAddress& member,
                                         const MacAddress& refuser, Time now) const {
  const auto tried = tree.refused.find(member);
  if (tried == tree.refused.end() || tried->second.size() >= kMostChildrenTried) return nullptr;
  const MacAddress* nearby = nullptr;
  const MacAddress* any = nullptr;
  for (const auto& [child, behind] : tree.children) {
    if (tried->second.count(child) != 0) continue;
    if (child == member || hears(child, member, now)) return &child;
    if (nearby == nullptr && hears(child, refuser, now)) nearby = &child;
    if (any == nullptr) any = &child;
  }
  if (nearby != nullptr) return nearby;
  return branches_.is_root(root) || !hears(refuser, member, now) ? any : nullptr;
}

/// As its beacons say.
bool TreeBuilder::hears(const MacAddress& neighbor, const MacAddress& robot, Time now) const {
  const routing::Neighbor* known = neighbors_.find(neighbor);
  const routing::Route* route = router_.table().find(robot);
  return known != nullptr && route != nullptr &&
         neighbors_.delivery(*known, wire::neighbor_tag(route->boot), now) > 0.0;
}

void TreeBuilder::link_lost(const MacAddress& neighbor) {
  for (auto& [root, branch] : branches_.all()) {
    give_up(root, branch.tree, {neighbor});
    if (branch.tree.upstream == neighbor) branch.tree.leave();
  }
}

void TreeBuilder::appeared(const Run& neighbor) {
  for (auto& [root, branch] : branches_.all()) branch.tree.appeared(neighbor);
}

void TreeBuilder::give_up(const MacAddress& root, Tree& tree, const std::vector<MacAddress>& children) {
  for (const MacAddress& address : children) {
    const auto child = tree.children.find(address);
    if (child == tree.children.end()) continue;
    const std::set<MacAddress> members = std::move(child->second);
    tree.children.erase(child);
    refuse(root, tree, members);
    changed_.push_back({root, false});
  }
}

void TreeBuilder::unreachable(const MacAddress& member, const std::string& reason, bool nearby) {
  for (auto& [root, branch] : branches_.all()) {
    const bool own = branches_.is_root(root);
    if (branch.tree.unrouted.count(member) == 0 || (nearby && own)) continue;
    branch.tree.unrouted.erase(member);
    branch.busy = true;
    if (own) {
      left_over_.push_back({{member}, reason, true});
    } else {
      refuse(root, branch.tree, {member});
    }
  }
}

}  // namespace adhoc_communication::multicast
