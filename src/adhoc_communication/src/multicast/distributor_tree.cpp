// How trees grow, lose branches and are built anew.
#include <algorithm>

#include "multicast/distributor.hpp"
#include "routing/sequence_number.hpp"

namespace adhoc_communication::multicast {

using wire::FrameType;

/// For what has come about this tree.
Tree* Distributor::find_tree(const MacAddress& root, wire::BootTag boot) {
  const auto found = trees_.find(root);
  if (found == trees_.end() || found->second.boot != boot) return nullptr;
  branches_.at(root).busy = true;
  return &found->second;
}

/// The tree of this run of the root; that of a former run is forgotten.
Tree& Distributor::tree_of(const MacAddress& root, wire::BootTag boot, Time now) {
  if (Tree* tree = find_tree(root, boot)) return *tree;
  forget_tree(root);
  if (trees_.size() >= kMostTrees) {
    const auto oldest = std::min_element(trees_.begin(), trees_.end(), [this](const auto& a, const auto& b) {
      return std::pair(is_root(a.first), a.second.last_used) < std::pair(is_root(b.first), b.second.last_used);
    });
    forget_tree(MacAddress(oldest->first));
  }
  Tree& tree = trees_[root];
  tree.boot = boot;
  tree.last_used = now;
  branches_[root];
  return tree;
}

void Distributor::forget_tree(const MacAddress& root) {
  const auto branch = branches_.find(root);
  if (branch == branches_.end()) return;
  for (GroupStream& stream : branch->second.streams) {
    while (!stream.transfers.empty()) erase_transfer(stream, stream.transfers.begin());
  }
  branches_.erase(branch);
  trees_.erase(root);
}

/// The root looks everywhere for its members. For a relay that knows no way, another robot is probably the better
/// place; it looks near by.
bool Distributor::look_for(const MacAddress& root, const MacAddress& member, Time now) {
  if (!is_root(root)) return router_.search_nearby(member, now);
  router_.search({member, {}}, now);
  return true;
}

/// Gives the members to the next hops of their routes; returns those that lead back to where they came from, and those
/// that cannot be looked for.
std::set<MacAddress> Distributor::attach(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members,
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
      tree.children[route->next_hop].insert(member);
      router_.used(root, member, tree.upstream.value_or(self_.address), now);
    }
  }
  return refused;
}

/// Members whose routes have been found meanwhile, or cannot be looked for.
void Distributor::attach_routed(Time now) {
  for (auto& [root, tree] : trees_) {
    std::set<MacAddress> routed;
    for (const MacAddress& member : tree.unrouted) {
      if (router_.route_to(member, now) != nullptr || !look_for(root, member, now)) routed.insert(member);
    }
    if (routed.empty()) continue;
    refuse(root, tree, attach(root, tree, routed, now));
    std::set<MacAddress> concerned;
    for (const auto& [child, members] : tree.children) {
      const bool concerns = std::any_of(routed.begin(), routed.end(), [&, &behind = members](const MacAddress& member) {
        return behind.count(member) != 0;
      });
      if (concerns) concerned.insert(child);
    }
    activate(root, tree, concerned);
    children_changed(root, false, now);
  }
}

void Distributor::activate(const MacAddress& root, const Tree& tree, const std::set<MacAddress>& children) {
  for (const MacAddress& child : children) {
    wire::GroupActivation activation{root, tree.boot, tree.epoch, {}};
    if (const auto found = tree.children.find(child); found != tree.children.end()) {
      activation.members.assign(found->second.begin(), found->second.end());
    }
    outbox_.unicast(child, FrameType::kGroupActivation, to_bytes(activation));
  }
}

/// A child that knows another tree has missed an activation, or its refusal was lost.
void Distributor::activate_again(const MacAddress& root, const Tree& tree, const MacAddress& child, Time now) {
  Time& last = branches_.at(root).activated_again[child];
  if (now - last < kActivationInterval) return;
  last = now;
  activate(root, tree, {child});
}

void Distributor::on_activation(const MacAddress& from, const wire::GroupActivation& activation, bool takes_part,
                                Time now) {
  if (is_root(activation.root)) return;
  Tree& tree = tree_of(activation.root, activation.root_boot, now);
  tree.last_used = now;
  const bool anew = tree.epoch == 0 || routing::is_newer(activation.epoch, tree.epoch);
  const bool stays = activation.epoch == tree.epoch && (!tree.upstream || tree.upstream == from);
  if (!anew && !stays) return turn_down(from, activation);
  const std::map<MacAddress, std::set<MacAddress>> before = std::exchange(tree.children, {});
  if (tree.upstream != from) forget_rhythm(branches_[activation.root]);
  if (anew) tree.refused.clear();
  tree.epoch = activation.epoch;
  tree.upstream = from;
  tree.unrouted.clear();
  std::set<MacAddress> members(activation.members.begin(), activation.members.end());
  const bool asked = members.erase(self_.address) != 0;
  tree.member = asked && takes_part;
  if (!anew) members = keep_attached(tree, before, std::move(members));
  std::set<MacAddress> refused = attach(activation.root, tree, members, now);
  if (asked && !takes_part) refused.insert(self_.address);
  refuse(activation.root, tree, refused);
  activate(activation.root, tree, changed_children(tree, before, anew));
  if (!tree.member) leave(tree);
  children_changed(activation.root, anew, now);
}

void Distributor::turn_down(const MacAddress& from, const wire::GroupActivation& activation) {
  if (activation.members.empty()) return;
  const wire::GroupRefusal refusal{activation.root, activation.root_boot, activation.epoch, activation.members};
  outbox_.unicast(from, FrameType::kGroupRefusal, to_bytes(refusal));
}

/// Who was attached stays where it is. Returns the others.
std::set<MacAddress> Distributor::keep_attached(Tree& tree, const std::map<MacAddress, std::set<MacAddress>>& before,
                                                std::set<MacAddress> members) {
  for (const auto& [child, behind] : before) {
    for (const MacAddress& member : behind) {
      if (members.erase(member) != 0) tree.children[child].insert(member);
    }
  }
  return members;
}

/// Those to which other members are entrusted than before, and those pruned.
std::set<MacAddress> Distributor::changed_children(const Tree& tree,
                                                   const std::map<MacAddress, std::set<MacAddress>>& before,
                                                   bool anew) {
  std::set<MacAddress> changed;
  for (const auto& [child, behind] : tree.children) {
    const auto found = before.find(child);
    if (anew || found == before.end() || found->second != behind) changed.insert(child);
  }
  for (const auto& [child, behind] : before) {
    if (!anew && tree.children.count(child) == 0) changed.insert(child);
  }
  return changed;
}

/// Counters and rounds of the former upstream neighbour mean nothing to a new one.
void Distributor::forget_rhythm(Branch& branch) {
  branch.last_counter = 0;
  branch.measured_counter = 0;
  for (GroupStream& stream : branch.streams) {
    for (auto& [number, transfer] : stream.transfers) transfer.round = 0;
  }
}

/// Gives members back to whoever entrusted them to this robot.
void Distributor::refuse(const MacAddress& root, Tree& tree, const std::set<MacAddress>& members) {
  if (members.empty()) return;
  if (is_root(root)) return refused_at_root(members, "the tree does not reach it", false);
  if (!tree.upstream) return;
  outbox_.unicast(*tree.upstream, FrameType::kGroupRefusal,
                  to_bytes(wire::GroupRefusal{root, tree.boot, tree.epoch, {members.begin(), members.end()}}));
  if (!tree.member) leave(tree);
}

/// With nobody behind it, this robot may get another place in the tree of the same epoch.
void Distributor::leave(Tree& tree) {
  if (tree.children.empty() && tree.unrouted.empty()) tree.upstream.reset();
}

void Distributor::on_refusal(const MacAddress& from, const wire::GroupRefusal& refusal, Time now) {
  Tree* tree = find_tree(refusal.root, refusal.root_boot);
  if (tree == nullptr || refusal.epoch != tree->epoch) return;
  const auto child = tree->children.find(from);
  if (child == tree->children.end()) return;
  std::set<MacAddress> refused;
  for (const MacAddress& member : refusal.members) {
    if (child->second.erase(member) == 0) continue;
    refused.insert(member);
    tree->refused[member].insert(from);
  }
  if (child->second.empty()) tree->children.erase(child);
  refuse(refusal.root, *tree, attach_elsewhere(refusal.root, *tree, refused));
  children_changed(refusal.root, false, now);
}

/// The routes to two members may meet at a robot, coming from different neighbours of which only one can be its
/// upstream neighbour. Perhaps the child that leads there reaches the other member, too. Returns those left over.
std::set<MacAddress> Distributor::attach_elsewhere(const MacAddress& root, Tree& tree,
                                                   const std::set<MacAddress>& members) {
  std::set<MacAddress> left;
  std::set<MacAddress> concerned;
  for (const MacAddress& member : members) {
    const std::set<MacAddress>& tried = tree.refused[member];
    const auto other = std::find_if(tree.children.begin(), tree.children.end(),
                                    [&](const auto& child) { return tried.count(child.first) == 0; });
    if (other == tree.children.end() || tried.size() >= kMostChildrenTried) {
      left.insert(member);
    } else {
      other->second.insert(member);
      concerned.insert(other->first);
    }
  }
  activate(root, tree, concerned);
  return left;
}

void Distributor::link_lost(const MacAddress& neighbor, Time now) {
  for (auto& [root, tree] : trees_) {
    give_up(root, tree, {neighbor}, now);
    if (tree.upstream == neighbor) leave(tree);
  }
}

/// These children are of no use: what is behind them goes back upstream.
void Distributor::give_up(const MacAddress& root, Tree& tree, const std::vector<MacAddress>& children, Time now) {
  for (const MacAddress& address : children) {
    const auto child = tree.children.find(address);
    if (child == tree.children.end()) continue;
    const std::set<MacAddress> members = std::move(child->second);
    tree.children.erase(child);
    refuse(root, tree, members);
    children_changed(root, false, now);
  }
}

void Distributor::unreachable(const MacAddress& member, const std::string& reason, bool nearby) {
  for (auto& [root, tree] : trees_) {
    if (tree.unrouted.count(member) == 0 || (nearby && is_root(root))) continue;
    tree.unrouted.erase(member);
    branches_.at(root).busy = true;
    if (is_root(root)) {
      refused_at_root({member}, reason, true);
    } else {
      refuse(root, tree, {member});
    }
  }
}

/// Once is bad luck, and a new tree gets there; a member refused again is served by itself. To be served by itself with
/// a few frames costs less than a new tree.
void Distributor::refused_at_root(const std::set<MacAddress>& members, const std::string& reason, bool final) {
  Branch& branch = branches_[self_.address];
  for (const MacAddress& member : members) {
    const Awaited waiting = awaited(member);
    if (!final && waiting == Awaited::kNothing) continue;  // the next packet for it looks for a way anew
    if (!final && waiting == Awaited::kLittle) refused_with_little(member);
    const bool by_copy = !final && (waiting == Awaited::kLittle || ++branch.refusals[member] >= kMostRefusals);
    if (!final && !by_copy) {
      branch.build_anew = true;
      continue;
    }
    branch.refusals.erase(member);
    for (GroupStream& stream : branch.streams) {
      for (auto& [number, transfer] : stream.transfers) {
        finish_member(transfer, {transfer.id, member, false, by_copy, reason});
      }
    }
  }
}

void Distributor::refused_with_little(const MacAddress& member) {
  Branch& branch = branches_.at(self_.address);
  if (branch.fresh) {
    branch.left_out.insert(member);
  } else if (branch.left_out.count(member) == 0) {
    branch.stale = true;
  }
}

/// What of own packets still has to reach the member.
Distributor::Awaited Distributor::awaited(const MacAddress& member) const {
  Awaited most = Awaited::kNothing;
  const auto own = branches_.find(self_.address);
  if (own == branches_.end()) return most;
  for (const GroupStream& stream : own->second.streams) {
    for (const auto& [number, transfer] : stream.transfers) {
      if (transfer.open.count(member) != 0)
        most = std::max(most, is_little(transfer) ? Awaited::kLittle : Awaited::kMuch);
    }
  }
  return most;
}

bool Distributor::is_little(const Transfer& transfer) {
  return transfer.packet->total() <= kFewFrames * std::size_t{transfer.packet->segment_size()};
}

/// A new epoch, with all members that a packet still has to reach.
void Distributor::build_anew(Time now) {
  const auto own = trees_.find(self_.address);
  if (own == trees_.end() || !branches_[self_.address].build_anew) return;
  branches_[self_.address].build_anew = false;
  Tree& tree = own->second;
  std::set<MacAddress> members;
  for (const auto& [child, behind] : tree.children) members.insert(behind.begin(), behind.end());
  for (const GroupStream& stream : branches_[self_.address].streams) {
    for (const auto& [number, transfer] : stream.transfers) members.insert(transfer.open.begin(), transfer.open.end());
  }
  next_epoch(tree);
  attach(self_.address, tree, members, now);
  activate(self_.address, tree, tree.child_addresses());
  children_changed(self_.address, true, now);
}

/// At the root, between two packets.
void Distributor::renew_stale(Tree& tree) {
  Branch& branch = branches_.at(self_.address);
  const bool at_work = std::any_of(branch.streams.begin(), branch.streams.end(),
                                   [](const GroupStream& stream) { return !stream.transfers.empty(); });
  branch.fresh = tree.epoch == 0 || (branch.stale && !at_work);
  if (branch.fresh) next_epoch(tree);
}

void Distributor::next_epoch(Tree& tree) {
  branches_.at(self_.address).stale = false;
  branches_.at(self_.address).left_out.clear();
  ++tree.epoch;
  tree.children.clear();
  tree.unrouted.clear();
  tree.refused.clear();
}

void Distributor::children_changed(const MacAddress& root, bool anew, Time now) {
  const Tree& tree = trees_.at(root);
  branches_.at(root).busy = true;
  const std::map<MacAddress, std::uint32_t> children = tree.coverages();
  for (GroupStream& stream : branches_.at(root).streams) {
    for (auto& [number, transfer] : stream.transfers) transfer.to_children->set_children(children, anew, now);
  }
}

}  // namespace adhoc_communication::multicast
