#include "node/network_logs.hpp"

#include <algorithm>
#include <sstream>

namespace adhoc_communication {
namespace {

constexpr long long kSummaryInterval = 5000;  // ms

std::size_t valid_routes(const NetworkState& state) {
  return static_cast<std::size_t>(std::count_if(state.routes.begin(), state.routes.end(),
                                                [](const NetworkRoute& route) { return route.valid != 0; }));
}

/// What makes two routing tables different to a reader of the log.
std::string outline(const NetworkState& state) {
  std::ostringstream text;
  for (const NetworkRoute& route : state.routes) {
    text << route.destination << ' ' << route.next_hop << ' ' << int{route.hops} << ' ' << int{route.valid} << '\n';
  }
  text << state.groups.size();
  return text.str();
}

std::uint64_t frames_dropped(const NetworkState& state) {
  return state.frames_malformed + state.frames_unsealed + state.frames_without_key + state.frames_forged +
         state.frames_replayed + state.frames_reflected + state.frames_unproven;
}

}  // namespace

NetworkLogs::NetworkLogs(const std::string& log_path, const std::string& robot)
    : routes_(log_path, robot, "routing_table.csv",
              "#time, num_cr_entries, num_unicast_entries, num_multicast_entries, size"),
      memory_(log_path, robot, "packet_memory_consumption.csv",
              "#time, packets_waiting, octets_waiting, frames_waiting, events_waiting, packets_to_publish, "
              "octets_to_publish, relay_octets_waiting"),
      traffic_(log_path, robot, "unicast_datalink_transmission_summary.csv",
               "#time, frames_sent, bytes_sent, frames_received, bytes_received, frames_given_up, frames_dropped, "
               "packets_sent, packets_failed, packets_received") {}

void NetworkLogs::add(const NetworkState& state, long long time) {
  add_routes(state, time);
  if (time < next_summary_) return;
  next_summary_ = time + kSummaryInterval;
  add_memory(state, time);
  add_traffic(state, time);
}

/// Nothing is relayed cooperatively: that column is 0.
void NetworkLogs::add_routes(const NetworkState& state, long long time) {
  const std::string routes = outline(state);
  if (routes == last_routes_) return;
  last_routes_ = routes;
  std::ostringstream row;
  row << time << ", 0, " << valid_routes(state) << ", " << state.groups.size() << ", " << state.routes.size();
  routes_.add(row.str());
}

void NetworkLogs::add_memory(const NetworkState& state, long long time) {
  std::uint64_t frames = 0;
  for (const NetworkLink& link : state.links) frames += link.waiting;
  std::uint64_t relayed = 0;
  for (const RelayedTopic& relay : state.relays) relayed += relay.octets_waiting;
  std::ostringstream row;
  row << time << ", " << state.packets_waiting << ", " << state.octets_waiting << ", " << frames << ", "
      << state.events_waiting << ", " << state.packets_to_publish << ", " << state.octets_to_publish << ", " << relayed;
  memory_.add(row.str());
}

void NetworkLogs::add_traffic(const NetworkState& state, long long time) {
  std::uint64_t given_up = 0;
  for (const NetworkLink& link : state.links) given_up += link.given_up;
  std::uint64_t received = 0;
  for (const std::uint64_t packets : state.packets_received_by_hops) received += packets;
  std::ostringstream row;
  row << time << ", " << state.frames_sent << ", " << state.bytes_sent << ", " << state.frames_received << ", "
      << state.bytes_received << ", " << given_up << ", " << frames_dropped(state) << ", " << state.packets_sent << ", "
      << state.packets_failed << ", " << received;
  traffic_.add(row.str());
}

}  // namespace adhoc_communication
