// What holds for the trees of groups at any instant: the enabled links form a tree (B11.1), its root has nobody above
// (B2.2), and no robot goes back to an earlier tree of the same run of a root (B2.4). A link leads up to one run of a
// robot: who has not heard of the next run yet is not below it.
#pragma once

#include <vector>

#include "adhoc_communication/types.hpp"
#include "violation.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {

class TreeInvariants {
 public:
  explicit TreeInvariants(std::size_t robots) : trees_(robots), boots_(robots) {}

  void booted(std::size_t robot, const BootId& boot_id);
  void crashed(std::size_t robot) { trees_[robot].clear(); }
  /// The robot's trees are now these. Throws Violation.
  void changed(std::size_t robot, std::vector<TreeState> trees);

 private:
  const TreeState* find(std::size_t robot, const TreeState& same) const;
  void check_history(std::size_t robot, const TreeState& before) const;
  void check_way_up(std::size_t robot, const TreeState& tree) const;

  std::vector<std::vector<TreeState>> trees_;
  std::vector<wire::BootTag> boots_;
};

}  // namespace adhoc_communication
