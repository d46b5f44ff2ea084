#include "node/network_state.hpp"

#include "link/mac_address.hpp"
#include "relay/relay_entry.hpp"

namespace adhoc_communication {
namespace {

float seconds(Time time) { return std::chrono::duration<float>(time).count(); }

std::string name_or_address(const Snapshot& snapshot, const MacAddress& address) {
  const auto name = snapshot.names.find(address);
  return name == snapshot.names.end() ? to_text(address) : name->second;
}

NetworkLink link_message(const LinkState& link) {
  NetworkLink message;
  message.robot = link.name;
  message.address = to_text(link.address);
  message.two_way = link.two_way;
  message.loss = static_cast<float>(link.loss);
  message.waiting = static_cast<std::uint32_t>(link.waiting);
  message.in_flight = static_cast<std::uint32_t>(link.in_flight);
  message.given_up = link.given_up;
  message.silent_for = seconds(link.silent_for);
  return message;
}

NetworkRoute route_message(const Snapshot& snapshot, const RouteState& route) {
  NetworkRoute message;
  message.destination = name_or_address(snapshot, route.destination);
  message.next_hop = name_or_address(snapshot, route.next_hop);
  message.hops = route.hops;
  message.cost = static_cast<float>(route.cost);
  message.valid = route.valid;
  message.expires_in = seconds(std::max(route.expires - snapshot.now, Time::zero()));
  message.sequence_number = route.sequence;
  message.precursors = static_cast<std::uint16_t>(route.precursors.size());
  return message;
}

NetworkGroup group_message(const std::string& name, const GroupState& group) {
  NetworkGroup message;
  message.group = name;
  message.root = group.root;
  message.member = group.member;
  message.connected = group.connected;
  message.joining = group.joining;
  message.uplink = group.uplink;
  message.downlinks = group.downlinks;
  message.members = group.members;
  return message;
}

void set_drops(NetworkState& message, const FramesDropped& dropped) {
  message.frames_malformed = dropped.malformed;
  message.frames_unsealed = dropped.unsealed;
  message.frames_without_key = dropped.no_key;
  message.frames_forged = dropped.forged;
  message.frames_replayed = dropped.replayed;
  message.frames_reflected = dropped.reflected;
  message.frames_unproven = dropped.unproven;
}

void set_queues(NetworkState& message, const QueueState& queues, const Injector::Report& injector) {
  message.packets_waiting = static_cast<std::uint32_t>(queues.packets);
  message.octets_waiting = queues.octets;
  message.events_waiting = static_cast<std::uint32_t>(queues.events);
  message.packets_to_publish = static_cast<std::uint32_t>(injector.waiting);
  message.octets_to_publish = injector.octets;
  message.packets_not_published = injector.dropped;
}

/// The counters that both messages have under the same names.
template <typename Message>
void set_counters(Message& message, const Statistics& statistics) {
  message.frames_sent = statistics.frames_sent;
  message.bytes_sent = statistics.bytes_sent;
  message.frames_received = statistics.frames_received;
  message.bytes_received = statistics.bytes_received;
  message.packets_sent = statistics.packets_sent;
  message.packets_failed = statistics.packets_failed;
  message.packets_received_by_hops = statistics.packets_received_by_hops;
}

}  // namespace

Status status_message(const Snapshot& snapshot, const NodeState& node) {
  Status message;
  message.stamp = node.stamp;
  message.robot_name = node.robot_name;
  message.interface = node.interface;
  message.neighbors = snapshot.neighbors;
  message.robots = snapshot.robots;
  set_counters(message, snapshot.statistics);
  return message;
}

NetworkState network_state_message(const Snapshot& snapshot, const NodeState& node) {
  NetworkState message;
  message.stamp = node.stamp;
  message.robot_name = node.robot_name;
  message.interface = node.interface;
  message.address = to_text(node.address);
  message.interface_up = snapshot.link_up;
  message.sealed = node.sealed;
  message.robots = snapshot.robots;
  for (const LinkState& link : snapshot.links) message.links.push_back(link_message(link));
  for (const RouteState& route : snapshot.routes) message.routes.push_back(route_message(snapshot, route));
  for (const auto& [name, group] : snapshot.groups) message.groups.push_back(group_message(name, group));
  for (const RelayReport& relay : node.relays) message.relays.push_back(relayed_topic_message(relay));
  set_counters(message, snapshot.statistics);
  set_drops(message, snapshot.statistics.frames_dropped);
  set_queues(message, snapshot.queues, node.injector);
  message.log_rows_lost = node.log_rows_lost;
  message.frames_not_captured = node.frames_not_captured;
  message.frames_not_sent = snapshot.frames_not_sent;
  message.frames_missed = snapshot.frames_missed;
  const Statistics& statistics = snapshot.statistics;
  message.frames_sent_by_type.assign(statistics.frames_sent_by_type.begin(), statistics.frames_sent_by_type.end());
  message.frames_received_by_type.assign(statistics.frames_received_by_type.begin(),
                                         statistics.frames_received_by_type.end());
  return message;
}

RelayedTopic relayed_topic_message(const RelayReport& report) {
  RelayedTopic message;
  message.topic = report.entry.topic;
  message.destination = report.entry.destination;
  message.remote_topic = report.entry.remote_topic;
  message.priority = to_text(report.entry.priority);
  message.rate = report.entry.rate;
  message.latched = report.entry.latched;
  message.lifetime = report.entry.lifetime;
  message.newest_only = report.entry.newest_only;
  message.type = report.type;
  message.waiting = static_cast<std::uint32_t>(report.waiting);
  message.octets_waiting = report.octets;
  message.delivered = report.delivered;
  message.dropped = report.dropped;
  message.failed = report.failed;
  message.last_failure = report.last_failure;
  return message;
}

}  // namespace adhoc_communication
