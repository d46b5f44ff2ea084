// What hosts may look at, for status, diagnostics and tests. Nothing here changes the engine.
#include <algorithm>

#include "engine/implementation.hpp"
#include "routing/names.hpp"

namespace adhoc_communication {

std::vector<RouteState> Engine::Implementation::routes() const {
  std::vector<RouteState> result;
  for (const auto& [destination, route] : router_.table().routes()) {
    result.push_back({destination,
                      route.next_hop,
                      route.hops,
                      static_cast<double>(route.cost) / routing::kPerfectHop,
                      route.sequence,
                      route.sequence_valid,
                      route.valid,
                      route.repairable,
                      route.expires,
                      {route.precursors.begin(), route.precursors.end()},
                      route.boot});
  }
  return result;
}

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
    result.push_back({root, tree.boot, tree.epoch, tree.upstream, {children.begin(), children.end()}, tree.above.boot});
  }
  return result;
}

QueueState Engine::Implementation::queues() const {
  const transport::Reassembly::Fill fill = reassembly_.fill();
  return {sends_.waiting(), sends_.waiting_for_groups(), sends_.octets_waiting(), events_.size(), fill.streams,
          fill.groups,      fill.complete_groups};
}

std::optional<std::string> Engine::Implementation::name_of(const MacAddress& robot) const {
  return routing::name_of(self_, directory_, robot);
}

std::vector<std::string> Engine::Implementation::neighbors() const {
  std::vector<std::string> names;
  for (const auto& [address, neighbor] : neighbors_.all()) {
    const routing::Robot* robot = directory_.find(address);
    if (robot != nullptr && robot->announced) names.push_back(robot->name);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::vector<Record> Engine::Implementation::take_records() {
  statistics_.records_lost = journal_.lost();
  return journal_.take();
}

}  // namespace adhoc_communication
