// How full everything is that grows with what the air and the host bring.
#include <algorithm>

#include "engine/implementation.hpp"

namespace adhoc_communication {

std::vector<TableFill> Engine::Implementation::tables() const {
  std::size_t precursors = 0;
  for (const auto& [destination, route] : router_.table().routes()) {
    precursors = std::max(precursors, route.precursors.size());
  }
  std::size_t members_of_tree = 0;
  for (const auto& [root, branch] : distributor_.branches()) {
    members_of_tree = std::max(members_of_tree, branch.tree.largest_table());
  }
  return {
      {"neighbours", neighbors_.all().size(), routing::Neighbors::kMostNeighbors},
      {"links", hops_.size(), routing::Neighbors::kMostNeighbors},
      {"runs not proven", neighbors_.candidates(), routing::Neighbors::kMostNeighbors},
      {"robots with runs", runs_.size(), routing::LivingRuns::kMostRobots},
      {"robots", directory_.size(), routing::RobotDirectory::kMostRobots},
      {"routes", router_.table().size(), routing::RouteTable::kMostRoutes},
      {"precursors of a route", precursors, routing::RouteTable::kMostPrecursors},
      {"searches", router_.searches(), routing::RouteDiscovery::kMostSearches},
      {"searches for others", router_.searches_for_others(), routing::RouteDiscovery::kMostForOthers},
      {"requests remembered", router_.requests_remembered(), routing::RequestFlood::kMostRequests},
      {"floods remembered", flood_.remembered(), transport::FloodRelay::kMostSeen},
      {"streams", streams_.size(), transport::Streams::kMostStreams},
      {"sources", receivers_.size(), transport::StreamReceivers::kMostReceivers},
      {"octets put together", reassembly_.whole().taken(), reassembly_.whole().most()},
      {"octets put together of little packets", reassembly_.little().taken(), reassembly_.little().most()},
      {"broadcasts put together", broadcast_receiver_.packets(), transport::BroadcastReceiver::kMostPackets},
      {"sends", sends_.waiting(), Sends::kMostSends},
      {"octets of sends", sends_.octets_waiting(), sends_.most_octets()},
      {"events", events_.size(), 2 * EventQueue::kMostEvents},
      {"octets of events", events_.octets(), std::max(EventQueue::kMostOctets, options_.max_packet_size)},
      {"members", groups_.own_group().size(), multicast::OwnGroup::kMostMembers},
      {"members lost", groups_.own_group().absent(), multicast::OwnGroup::kMostAbsent},
      {"trees", distributor_.branches().size(), multicast::Branches::kMostTrees},
      {"members of a tree", members_of_tree, wire::kMostMembersOfActivation},
      {"flooded packets", distributor_.flooding().packets(), multicast::Flooding::kMostPackets},
      {"receipts", distributor_.receipts().kept(), multicast::Receipts::kMostKept},
      {"groups", groups_.memberships().size(), multicast::Memberships::kMostGroups},
      {"runs with keys", guard_.sessions(), security::FrameGuard::kMostSessions},
  };
}

}  // namespace adhoc_communication
