// What hosts may look at, for status, diagnostics and tests. Nothing here changes the engine.
#include <algorithm>

#include "engine_implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {

std::vector<LinkState> Engine::links() const { return implementation_->links(); }
std::vector<TreeState> Engine::trees() const { return implementation_->trees(); }
QueueState Engine::queues() const { return implementation_->queues(); }
std::vector<std::string> Engine::groups() const { return implementation_->groups(); }
std::optional<std::string> Engine::name_of(const MacAddress& robot) const { return implementation_->name_of(robot); }

std::vector<LinkState> Engine::Implementation::links() const {
  std::vector<LinkState> result;
  for (const auto& [address, neighbor] : neighbors_.all()) {
    LinkState state;
    state.address = address;
    state.name = name_of(address).value_or("");
    state.two_way = neighbors_.two_way(address, now_);
    state.silent_for = now_ - neighbor.last_heard;
    state.loss = neighbors_.loss(address);
    if (const transport::HopSender* sender = hops_.sender_to(address)) {
      state.waiting = sender->waiting();
      state.in_flight = sender->unresolved();
      state.given_up = sender->given_up();
    }
    result.push_back(std::move(state));
  }
  return result;
}

std::vector<TreeState> Engine::Implementation::trees() const {
  std::vector<TreeState> result;
  for (const auto& [root, branch] : distributor_.branches()) {
    const multicast::Tree& tree = branch.tree;
    const std::set<MacAddress> children = tree.child_addresses();
    result.push_back({root, tree.boot, tree.epoch, tree.upstream, {children.begin(), children.end()}});
  }
  return result;
}

QueueState Engine::Implementation::queues() const {
  const auto to_groups = std::count_if(sendings_.begin(), sendings_.end(), [](const auto& item) {
    return item.second.purpose == Purpose::kHost && multicast::root_of(item.second.destination);
  });
  const transport::Reassembly::Fill fill = reassembly_.fill();
  return {host_sends_,         static_cast<std::size_t>(to_groups),
          octets_waiting_,     events_.size(),
          fill.streams,        fill.groups,
          fill.complete_groups};
}

std::vector<std::string> Engine::Implementation::groups() const {
  std::vector<std::string> result{multicast::group_of(self_.name)};
  for (std::string& group : memberships_.groups()) result.push_back(std::move(group));
  return result;
}

std::optional<std::string> Engine::Implementation::name_of(const MacAddress& robot) const {
  if (robot == self_.address) return self_.name;
  const routing::Robot* known = directory_.find(robot);
  if (known == nullptr) return std::nullopt;
  return known->name;
}

std::string Engine::Implementation::name_or_address(const MacAddress& robot) const {
  return name_of(robot).value_or(address_text(robot));
}

}  // namespace adhoc_communication
