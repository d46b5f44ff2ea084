#include "multicast/branches.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {
namespace {

bool frame_waits(const GroupStream& stream) {
  return std::any_of(stream.transfers.begin(), stream.transfers.end(),
                     [](const auto& transfer) { return transfer.second.to_children->has_frame(); });
}

}  // namespace

void Branch::forget_rhythm() {
  last_counter = 0;
  measured_counter = 0;
  for (GroupStream& stream : streams) {
    for (auto& [number, transfer] : stream.transfers) transfer.round = 0;
  }
}

void Branch::children_changed(bool anew, Time now) {
  busy = true;
  const std::map<MacAddress, std::uint32_t> children = tree.coverages();
  for (GroupStream& stream : streams) {
    for (auto& [number, transfer] : stream.transfers) {
      if (!transfer.flooded) transfer.to_children->set_children(children, anew, now);
    }
  }
}

void Branch::lose_place(Time now) {
  if (!tree.upstream && tree.children.empty()) return;
  tree.lose_place();
  children_changed(false, now);
}

bool Branch::has_frame(std::size_t priority) const { return busy && frame_waits(streams[priority]); }

bool Branch::sends() const { return std::any_of(streams.begin(), streams.end(), frame_waits); }

Time Branch::next_deadline() const {
  Time next = Time::max();
  for (const GroupStream& stream : streams) {
    for (const auto& [number, transfer] : stream.transfers) {
      next = std::min(next, transfer.to_children->next_deadline());
      if (transfer.report_due) next = std::min(next, *transfer.report_due);
    }
  }
  return next;
}

Branch* Branches::find(const MacAddress& root, wire::BootTag boot) {
  const auto found = branches_.find(root);
  if (found == branches_.end() || found->second.tree.boot != boot) return nullptr;
  found->second.busy = true;
  return &found->second;
}

Branch& Branches::of(const MacAddress& root, wire::BootTag boot, Time now) {
  if (Branch* branch = find(root, boot)) return *branch;
  branches_.erase(root);
  if (branches_.size() >= kMostTrees) {
    branches_.erase(std::min_element(branches_.begin(), branches_.end(), [this](const auto& a, const auto& b) {
      return std::pair(is_root(a.first), a.second.tree.last_used) <
             std::pair(is_root(b.first), b.second.tree.last_used);
    }));
  }
  Branch& branch = branches_[root];
  branch.tree.boot = boot;
  branch.tree.last_used = now;
  return branch;
}

Branch* Branches::own() {
  const auto found = branches_.find(self_.address);
  return found == branches_.end() ? nullptr : &found->second;
}

void Branches::expire(Time now) {
  for (auto item = branches_.begin(); item != branches_.end();) {
    auto& [root, branch] = *item;
    const bool own = is_root(root);
    if (!own && now - branch.tree.heard_above >= kIdleTree) branch.lose_place(now);
    const bool idle = !own && now - branch.tree.last_used >= (branch.tree.bound ? kBoundTree : kIdleTree);
    item = idle ? branches_.erase(item) : std::next(item);
  }
}

}  // namespace adhoc_communication::multicast
