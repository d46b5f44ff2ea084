#include "route_invariants.hpp"

#include <tuple>

#include "routing/sequence_number.hpp"
#include "wire/octets.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

/// Team gives robot i the address 02:00:00:00:i/256:i%256.
std::size_t robot_of(const MacAddress& address) { return std::size_t{address[4]} * 256 + address[5]; }

std::string name(std::size_t robot) { return "robot_" + std::to_string(robot); }

}  // namespace

void RouteInvariants::booted(std::size_t robot, const BootId& boot_id) {
  crashed(robot);
  const int order = static_cast<int>(runs_.size()) + 1;
  runs_.emplace(wire::boot_tag(boot_id), order);
}

void RouteInvariants::crashed(std::size_t robot) { tables_[robot].assign(tables_.size(), Entry{}); }

void RouteInvariants::changed(std::size_t robot, const std::vector<RouteState>& routes, Time now) {
  Table table(tables_.size());
  for (const RouteState& route : routes) {
    const std::size_t destination = robot_of(route.destination);
    if (destination < table.size()) table[destination] = entry_of(route);
  }
  tables_[robot].swap(table);
  for (std::size_t destination = 0; destination < tables_.size(); ++destination) {
    check_history(robot, destination, table[destination], tables_[robot][destination]);
    check_loop(robot, destination, now);
    check_downhill(robot, destination, now);
    for (std::size_t upstream = 0; upstream < tables_.size(); ++upstream) {
      if (tables_[upstream][destination].next_hop == robot) check_downhill(upstream, destination, now);
    }
  }
}

RouteInvariants::Entry RouteInvariants::entry_of(const RouteState& route) const {
  const auto run = runs_.find(route.boot);
  const std::size_t next_hop = robot_of(route.next_hop);
  return {true,
          route.valid,
          route.sequence_valid,
          next_hop < tables_.size() ? next_hop : kNobody,
          route.cost,
          run == runs_.end() ? 0 : run->second,
          route.sequence,
          route.expires};
}

/// A2.5. An entry that was deleted (DELETE_PERIOD) is forgotten and may start anew.
void RouteInvariants::check_history(std::size_t robot, std::size_t destination, const Entry& before,
                                    const Entry& after) const {
  if (!before.present || !after.present || !before.sequence_valid) return;
  const bool older_run = after.run < before.run;
  const bool older_number =
      after.run == before.run && after.sequence_valid && routing::is_newer(before.sequence, after.sequence);
  const bool forgotten = after.run == before.run && !after.sequence_valid;
  if (!older_run && !older_number && !forgotten) return;
  throw Violation("A2.5: the sequence number that " + name(robot) + " stores for " + name(destination) +
                  " went back from " + std::to_string(before.sequence) + " (run " + std::to_string(before.run) +
                  ") to " + (after.sequence_valid ? std::to_string(after.sequence) : "unknown") + " (run " +
                  std::to_string(after.run) + ")");
}

/// A13.1.
void RouteInvariants::check_loop(std::size_t robot, std::size_t destination, Time now) const {
  std::vector<bool> visited(tables_.size());
  std::string way;
  for (std::size_t at = robot; at != destination;) {
    const Entry& entry = tables_[at][destination];
    if (!entry.usable(now) || entry.next_hop == kNobody) return;
    visited[at] = true;
    at = entry.next_hop;
    if (!visited[at]) continue;
    for (std::size_t member = 0; member < visited.size(); ++member) {
      if (visited[member]) way += "; " + text(member, destination);
    }
    throw Violation("A13.1: the route from " + name(robot) + " to " + name(destination) + " comes back to " + name(at) +
                    way);
  }
}

/// A13.2: (number, -cost) grows from a robot to its next hop, unless that one hears the destination itself.
void RouteInvariants::check_downhill(std::size_t robot, std::size_t destination, Time now) const {
  const Entry& here = tables_[robot][destination];
  if (!here.usable(now) || here.next_hop == kNobody || here.next_hop == destination) return;
  const Entry& next = tables_[here.next_hop][destination];
  if (!next.usable(now) || !here.sequence_valid || !next.sequence_valid || next.next_hop == destination) return;
  if (next.run != here.run) {
    if (next.run > here.run) return;
  } else if (routing::is_newer(next.sequence, here.sequence) ||
             (next.sequence == here.sequence && next.cost < here.cost)) {
    return;
  }
  throw Violation("A13.2: freshness decreases along a route to " + name(destination) + ": " + text(robot, destination) +
                  "; " + text(here.next_hop, destination));
}

std::string RouteInvariants::text(std::size_t robot, std::size_t destination) const {
  const Entry& entry = tables_[robot][destination];
  return name(robot) + " by way of " + name(entry.next_hop) + " (run " + std::to_string(entry.run) + ", number " +
         (entry.sequence_valid ? std::to_string(entry.sequence) : "unknown") + ", " + "cost " +
         std::to_string(entry.cost) + ")";
}

}  // namespace adhoc_communication
