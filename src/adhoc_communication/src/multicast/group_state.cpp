// What hosts may look at, as the contract words it.
#include "multicast/group_traffic.hpp"
#include "routing/names.hpp"

namespace adhoc_communication::multicast {

const Tree* GroupTraffic::tree_of(const MacAddress& root) const {
  const auto found = distributor_.branches().find(root);
  return found == distributor_.branches().end() ? nullptr : &found->second.tree;
}

/// The children in the tree, and for members that no packet has made part of it yet the neighbours that will be.
std::set<MacAddress> GroupTraffic::ways_to_members(Time now) const {
  const Tree* tree = tree_of(self_.address);
  std::set<MacAddress> ways;
  for (const std::string& name : own_group_.names()) {
    const auto address = directory_.address_of(name);
    if (!address || (tree != nullptr && tree->holds(*address))) continue;
    if (const routing::Route* route = router_.route_to(*address, now)) ways.insert(route->next_hop);
  }
  if (tree != nullptr) ways.merge(tree->child_addresses());
  return ways;
}

GroupState GroupTraffic::state_of_own(Time now) const {
  GroupState state;
  state.known = state.member = state.activated = state.connected = state.root = true;
  state.members = own_group_.names();
  for (const MacAddress& neighbor : ways_to_members(now)) {
    state.downlinks.push_back(routing::name_or_address(self_, directory_, neighbor));
  }
  return state;
}

GroupState GroupTraffic::state(const std::string& group, Time now) const {
  const auto root = root_of(group);
  if (!root) return {};
  if (*root == self_.name) return state_of_own(now);
  GroupState state;
  const auto address = directory_.address_of(*root);
  const Tree* tree = address ? tree_of(*address) : nullptr;
  const bool on_tree = tree != nullptr && tree->upstream;
  const Membership* membership = memberships_.find(group);
  const bool wanted = membership != nullptr && membership->wanted;
  if (!wanted && !on_tree) return state;
  state.known = true;
  if (wanted) {
    state.member = membership->joined;
    state.joining = membership->joining;
  }
  state.activated = state.connected = on_tree || (wanted && membership->joined);
  const routing::Route* route = address ? router_.route_to(*address, now) : nullptr;
  const auto name = [&](const MacAddress& robot) { return routing::name_or_address(self_, directory_, robot); };
  if (on_tree) {
    for (const auto& [child, members] : tree->children) state.downlinks.push_back(name(child));
  }
  if (!on_tree && route == nullptr) return state;
  const std::string hops = std::to_string(route == nullptr ? 1 : route->hops);
  state.uplink = name(on_tree ? *tree->upstream : route->next_hop);
  state.route_uplink = "Next hop:" + state.uplink + " RD:" + hops + " HOBS:" + hops + " CH:" + hops;
  return state;
}

std::vector<std::string> GroupTraffic::groups() const {
  std::vector<std::string> result{group_of(self_.name)};
  for (std::string& group : memberships_.groups()) result.push_back(std::move(group));
  return result;
}

}  // namespace adhoc_communication::multicast
