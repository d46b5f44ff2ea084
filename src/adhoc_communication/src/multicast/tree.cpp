#include "multicast/tree.hpp"

#include <algorithm>
#include <iterator>

namespace adhoc_communication::multicast {

std::uint32_t digest(const MacAddress& member) {
  std::uint64_t value = 0;
  for (const std::uint8_t octet : member) value = value << 8 | octet;
  value = (value ^ value >> 30) * 0xbf58476d1ce4e5b9u;
  value = (value ^ value >> 27) * 0x94d049bb133111ebu;
  return static_cast<std::uint32_t>(value ^ value >> 31);
}

std::set<MacAddress> Tree::child_addresses() const {
  std::set<MacAddress> addresses;
  for (const auto& [child, members] : children) addresses.insert(child);
  return addresses;
}

std::map<MacAddress, std::uint32_t> Tree::coverages() const {
  std::map<MacAddress, std::uint32_t> result;
  for (const auto& [child, members] : children) result[child] = coverage(child);
  return result;
}

std::uint32_t Tree::coverage(const MacAddress& child) const {
  std::uint32_t sum = 0;
  if (const auto found = children.find(child); found != children.end()) {
    for (const MacAddress& address : found->second) sum ^= digest(address);
  }
  return sum;
}

std::uint32_t Tree::own_coverage(const MacAddress& self) const {
  std::uint32_t sum = member ? digest(self) : 0;
  for (const auto& [child, members] : children) sum ^= coverage(child);
  for (const MacAddress& address : unrouted) sum ^= digest(address);
  return sum;
}

bool Tree::holds(const MacAddress& address) const {
  if (unrouted.count(address) != 0) return true;
  return std::any_of(children.begin(), children.end(),
                     [&](const auto& child) { return child.second.count(address) != 0; });
}

bool Tree::may_be_below(const Run& run) const {
  if (upstream) return upstream == run.robot;
  return !bound || above == run;
}

void Tree::take_place(const Run& below, std::uint32_t in_epoch, Time now) {
  if (in_epoch != epoch) {
    refused.clear();
    bound = false;
  }
  epoch = in_epoch;
  upstream = below.robot;
  above = below;
  heard_above = now;
}

void Tree::entrust(const MacAddress& address, const MacAddress& child) {
  children[child].insert(address);
  bound = true;
}

std::optional<MacAddress> Tree::remove(const MacAddress& address) {
  unrouted.erase(address);
  for (auto iterator = children.begin(); iterator != children.end(); ++iterator) {
    if (iterator->second.erase(address) == 0) continue;
    return iterator->first;
  }
  return std::nullopt;
}

std::set<MacAddress> Tree::ways_to(const std::set<MacAddress>& members) const {
  std::set<MacAddress> ways;
  for (const auto& [child, behind] : children) {
    const bool leads_there = std::any_of(members.begin(), members.end(), [&, &reached = behind](const auto& member) {
      return reached.count(member) != 0;
    });
    if (leads_there) ways.insert(child);
  }
  return ways;
}

std::set<MacAddress> Tree::keep_attached(const std::map<MacAddress, std::set<MacAddress>>& before,
                                         std::set<MacAddress> members) {
  for (const auto& [child, behind] : before) {
    for (const MacAddress& address : behind) {
      if (members.erase(address) != 0) children[child].insert(address);
    }
  }
  return members;
}

std::set<MacAddress> Tree::changed_children(const std::map<MacAddress, std::set<MacAddress>>& before, bool anew) const {
  std::set<MacAddress> changed;
  for (const auto& [child, behind] : children) {
    const auto found = before.find(child);
    if (anew || found == before.end() || found->second != behind) changed.insert(child);
  }
  for (const auto& [child, behind] : before) {
    if (!anew && children.count(child) == 0) changed.insert(child);
  }
  return changed;
}

void Tree::forget_former_children() {
  for (auto entry = activated_again.begin(); entry != activated_again.end();) {
    entry = children.count(entry->first) != 0 ? std::next(entry) : activated_again.erase(entry);
  }
}

void Tree::forget_refusals_of_others(const std::set<MacAddress>& members) {
  for (auto entry = refused.begin(); entry != refused.end();) {
    entry = members.count(entry->first) != 0 ? std::next(entry) : refused.erase(entry);
  }
}

std::size_t Tree::largest_table() const {
  std::size_t held = unrouted.size();
  for (const auto& [child, members] : children) held += members.size();
  return std::max({held, refused.size(), activated_again.size()});
}

void Tree::leave() {
  if (children.empty() && unrouted.empty()) upstream.reset();
}

void Tree::appeared(const Run& neighbor) {
  if (upstream != neighbor.robot || above == neighbor) return;
  upstream.reset();
  unrouted.clear();
}

void Tree::lose_place() {
  upstream.reset();
  children.clear();
  unrouted.clear();
}

void Tree::next_epoch() {
  ++epoch;
  children.clear();
  unrouted.clear();
  refused.clear();
}

}  // namespace adhoc_communication::multicast
