#include "node/network_logs.hpp"

#include <algorithm>
#include <sstream>

#include "node/csv_row.hpp"
#include "node/log_columns.hpp"
#include "node/traffic_rows.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr long long kSummaryInterval = 5000;  // ms
constexpr int kNone = 0;                      // nothing is relayed cooperatively

std::size_t valid_routes(const Snapshot& snapshot) {
  return static_cast<std::size_t>(std::count_if(snapshot.routes.begin(), snapshot.routes.end(),
                                                [](const RouteState& route) { return route.valid; }));
}

/// What makes two routing tables different to a reader of the log.
std::string outline(const Snapshot& snapshot) {
  std::ostringstream text;
  for (const RouteState& route : snapshot.routes) {
    text << address_text(route.destination) << ' ' << address_text(route.next_hop) << ' ' << int{route.hops} << ' '
         << route.valid << '\n';
  }
  text << snapshot.groups.size();
  return text.str();
}

/// Where the original had a thread for each frame or packet under way, there is the number of these.
std::string memory_row(const Snapshot& snapshot, long long time) {
  std::size_t in_flight = 0;
  for (const LinkState& link : snapshot.links) in_flight += link.in_flight;
  const QueueState& queues = snapshot.queues;
  return csv_row(time, queues.complete_group_octets, queues.group_octets, queues.stream_octets, kNone, in_flight,
                 queues.group_packets, kNone, queues.packets - queues.group_packets);
}

}  // namespace

NetworkLogs::NetworkLogs(const std::string& log_path, const std::string& robot)
    : routes_(log_path, robot, "routing_table.csv", log_columns::kRoutingTable),
      memory_(log_path, robot, "packet_memory_consumption.csv", log_columns::kMemory),
      unicast_(log_path, robot, "unicast_datalink_transmission_summary.csv", log_columns::kUnicastSummary),
      multicast_(log_path, robot, "multicast.csv", log_columns::kMulticastSummary) {}

void NetworkLogs::add(const Snapshot& snapshot, long long time) {
  add_routes(snapshot, time);
  // Or the clock was set back.
  const bool is_due = time >= next_summary_ || time < next_summary_ - kSummaryInterval;
  if (!is_due) return;
  next_summary_ = time + kSummaryInterval;
  memory_.add(memory_row(snapshot, time));
  unicast_.add(unicast_row(snapshot.statistics, time));
  multicast_.add(multicast_row(snapshot.statistics, time));
}

void NetworkLogs::add_routes(const Snapshot& snapshot, long long time) {
  const std::string routes = outline(snapshot);
  if (routes == last_routes_) return;
  last_routes_ = routes;
  const std::size_t octets = snapshot.routes.size() * sizeof(RouteState) + snapshot.groups.size() * sizeof(GroupState);
  routes_.add(csv_row(time, kNone, valid_routes(snapshot), snapshot.groups.size(), octets));
}

}  // namespace adhoc_communication
