#include "api/introspection.hpp"

#include <algorithm>

#include "routing/names.hpp"

namespace adhoc_communication {

std::vector<RouteState> Introspection::routes() const {
  std::vector<RouteState> result;
  for (const auto& [destination, route] : layers_.router.table().routes()) {
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

std::vector<LinkState> Introspection::links(Time now) const {
  std::vector<LinkState> result;
  for (const auto& [address, neighbor] : layers_.neighbors.all()) {
    LinkState state;
    state.address = address;
    state.name = name_of(address).value_or("");
    state.two_way = layers_.neighbors.two_way(address, now);
    state.silent_for = now - neighbor.last_heard;
    state.loss = layers_.neighbors.loss(address);
    if (const transport::HopSender* sender = layers_.hops.sender_to(address)) {
      state.waiting = sender->waiting();
      state.in_flight = sender->unresolved();
      state.given_up = sender->given_up();
    }
    result.push_back(std::move(state));
  }
  return result;
}

std::vector<TreeState> Introspection::trees() const {
  std::vector<TreeState> result;
  for (const auto& [root, branch] : layers_.distributor.branches()) {
    const multicast::Tree& tree = branch.tree;
    const std::set<MacAddress> children = tree.child_addresses();
    result.push_back({root, tree.boot, tree.epoch, tree.upstream, {children.begin(), children.end()}, tree.above.boot});
  }
  return result;
}

QueueState Introspection::queues() const {
  const transport::Reassembly::Fill fill = layers_.reassembly.fill();
  return {layers_.sends.waiting(),
          layers_.sends.waiting_for_groups(),
          layers_.sends.octets_waiting(),
          layers_.events.size(),
          fill.streams,
          fill.groups,
          fill.complete_groups};
}

std::optional<std::string> Introspection::name_of(const MacAddress& robot) const {
  return routing::name_of(layers_.self, layers_.directory, robot);
}

std::vector<std::string> Introspection::neighbors() const {
  std::vector<std::string> names;
  for (const auto& [address, neighbor] : layers_.neighbors.all()) {
    const routing::Robot* robot = layers_.directory.find(address);
    if (robot != nullptr && robot->announced) names.push_back(robot->name);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

std::vector<TableFill> Introspection::tables() const {
  std::size_t precursors = 0;
  for (const auto& [destination, route] : layers_.router.table().routes()) {
    precursors = std::max(precursors, route.precursors.size());
  }
  std::size_t members_of_tree = 0;
  for (const auto& [root, branch] : layers_.distributor.branches()) {
    members_of_tree = std::max(members_of_tree, branch.tree.largest_table());
  }
  return {
      {"neighbours", layers_.neighbors.all().size(), routing::Neighbors::kMostNeighbors},
      {"links", layers_.hops.size(), routing::Neighbors::kMostNeighbors},
      {"runs not proven", layers_.neighbors.candidates(), routing::Neighbors::kMostNeighbors},
      {"robots with runs", layers_.runs.size(), routing::LivingRuns::kMostRobots},
      {"robots", layers_.directory.size(), routing::RobotDirectory::kMostRobots},
      {"routes", layers_.router.table().size(), routing::RouteTable::kMostRoutes},
      {"precursors of a route", precursors, routing::RouteTable::kMostPrecursors},
      {"searches", layers_.router.searches(), routing::RouteDiscovery::kMostSearches},
      {"searches for others", layers_.router.searches_for_others(), routing::RouteDiscovery::kMostForOthers},
      {"requests remembered", layers_.router.requests_remembered(), routing::RequestFlood::kMostRequests},
      {"floods remembered", layers_.floods.remembered(), transport::FloodRelay::kMostSeen},
      {"streams", layers_.streams.size(), transport::Streams::kMostStreams},
      {"sources", layers_.receivers.size(), transport::StreamReceivers::kMostReceivers},
      {"octets put together", layers_.reassembly.whole().taken(), layers_.reassembly.whole().most()},
      {"octets put together of little packets", layers_.reassembly.little().taken(),
       layers_.reassembly.little().most()},
      {"broadcasts put together", layers_.broadcasts.packets(), transport::BroadcastReceiver::kMostPackets},
      {"sends", layers_.sends.waiting(), Sends::kMostSends},
      {"octets of sends", layers_.sends.octets_waiting(), layers_.sends.most_octets()},
      {"events", layers_.events.size(), 2 * EventQueue::kMostEvents},
      {"octets of events", layers_.events.octets(), std::max(EventQueue::kMostOctets, layers_.max_packet_size)},
      {"members", layers_.groups.own_group().size(), multicast::OwnGroup::kMostMembers},
      {"members lost", layers_.groups.own_group().absent(), multicast::OwnGroup::kMostAbsent},
      {"trees", layers_.distributor.branches().size(), multicast::Branches::kMostTrees},
      {"members of a tree", members_of_tree, wire::kMostMembersOfActivation},
      {"flooded packets", layers_.distributor.flooding().packets(), multicast::Flooding::kMostPackets},
      {"receipts", layers_.distributor.receipts().kept(), multicast::Receipts::kMostKept},
      {"groups", layers_.groups.memberships().size(), multicast::Memberships::kMostGroups},
      {"runs with keys", layers_.guard.sessions(), security::FrameGuard::kMostSessions},
  };
}

}  // namespace adhoc_communication
