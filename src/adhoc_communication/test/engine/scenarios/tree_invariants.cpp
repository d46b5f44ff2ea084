#include "tree_invariants.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "routing/sequence_number.hpp"

namespace adhoc_communication {
namespace {

/// Team gives robot i the address 02:00:00:00:i/256:i%256.
std::size_t robot_of(const MacAddress& address) { return std::size_t{address[4]} * 256 + address[5]; }

std::string name(std::size_t robot) { return "robot_" + std::to_string(robot); }

}  // namespace

void TreeInvariants::booted(std::size_t robot, const BootId& boot_id) {
  crashed(robot);
  boots_[robot] = wire::boot_tag(boot_id);
}

void TreeInvariants::changed(std::size_t robot, std::vector<TreeState> trees) {
  trees_[robot].swap(trees);
  for (const TreeState& before : trees) check_history(robot, before);
  for (const TreeState& tree : trees_[robot]) check_way_up(robot, tree);
}

const TreeState* TreeInvariants::find(std::size_t robot, const TreeState& same) const {
  const auto found = std::find_if(trees_[robot].begin(), trees_[robot].end(), [&](const TreeState& tree) {
    return tree.root == same.root && tree.boot == same.boot;
  });
  return found == trees_[robot].end() ? nullptr : &*found;
}

void TreeInvariants::check_history(std::size_t robot, const TreeState& before) const {
  const TreeState* after = find(robot, before);
  if (after == nullptr || !routing::is_newer(before.epoch, after->epoch)) return;
  throw Violation("B2.4: the tree of " + name(robot_of(before.root)) + " at " + name(robot) + " went back from epoch " +
                  std::to_string(before.epoch) + " to " + std::to_string(after->epoch));
}

void TreeInvariants::check_way_up(std::size_t robot, const TreeState& tree) const {
  const std::size_t root = robot_of(tree.root);
  if (robot == root && tree.upstream) throw Violation("B2.2: the root " + name(root) + " has somebody above");
  std::vector<bool> visited(trees_.size());
  std::string way = name(robot);
  const TreeState* at = &tree;
  for (std::size_t member = robot; at != nullptr && at->epoch == tree.epoch && at->upstream;) {
    visited[member] = true;
    member = robot_of(*at->upstream);
    if (member >= trees_.size() || member == root || at->upstream_boot != boots_[member]) return;
    way += ", " + name(member);
    if (visited[member]) {
      throw Violation("B11.1: the way up the tree of " + name(root) + ", epoch " + std::to_string(tree.epoch) +
                      ", comes back: " + way);
    }
    at = find(member, tree);
  }
}

}  // namespace adhoc_communication
