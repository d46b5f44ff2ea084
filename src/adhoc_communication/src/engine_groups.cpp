// Membership of groups.
#include "engine_implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {

using transport::PacketKind;

SendId Engine::Implementation::send_control(const std::string& destination, PacketKind kind, const std::string& group,
                                            Bytes payload, Purpose purpose, Time now) {
  const transport::Image image = transport::encode({kind, 0, group, {}, std::move(payload)});
  return start_unicast(destination, image, Priority::kControl, {purpose, destination, group, 0, 0}, now);
}

void Engine::Implementation::join_group(const std::string& group, Time now) {
  touch(now);
  const auto root = multicast::root_of(group);
  if (!root) return report(GroupChangeFinished{group, true, false, group + " is not the name of a group (mc_<robot>)"});
  if (*root == self_.name) return report(GroupChangeFinished{group, true, true, {}});
  if (groups_.memberships.count(group) == 0 && groups_.memberships.size() >= multicast::Groups::kMostGroups) {
    return report(GroupChangeFinished{
        group, true, false,
        "already a member of " + std::to_string(groups_.memberships.size()) + " groups, no more are kept"});
  }
  multicast::Membership& membership = groups_.memberships[group];
  membership.wanted = true;
  if (membership.joined) return report(GroupChangeFinished{group, true, true, {}});
  membership.asked_by_host = true;
  start_join(group, now);
}

void Engine::Implementation::leave_group(const std::string& group, Time now) {
  touch(now);
  if (group == multicast::group_of(self_.name)) {
    return report(GroupChangeFinished{group, false, false, "the root cannot leave its own group " + group});
  }
  const auto found = groups_.memberships.find(group);
  if (found == groups_.memberships.end() || !found->second.wanted) {
    return report(GroupChangeFinished{group, false, false, "this robot is not a member of " + group});
  }
  // Left at once for this robot; the root hears of it as soon as it can be reached.
  found->second = multicast::Membership{};
  found->second.wanted = false;
  send_control(*multicast::root_of(group), PacketKind::kGroupLeave, group, {}, Purpose::kLeave, now);
  report(GroupChangeFinished{group, false, true, {}});
}

void Engine::Implementation::start_join(const std::string& group, Time now) {
  if (groups_.memberships.count(group) == 0 && groups_.memberships.size() >= multicast::Groups::kMostGroups) return;
  multicast::Membership& membership = groups_.memberships[group];
  if (!membership.wanted || membership.joining || membership.joined) return;
  membership.joining = true;
  send_control(*multicast::root_of(group), PacketKind::kGroupJoin, group, {}, Purpose::kJoin, now);
}

/// Joins that failed are tried again while the root is known.
void Engine::Implementation::join_due_groups(Time now) {
  if (!options_.join_groups_automatically) return;
  for (auto& [group, membership] : groups_.memberships) {
    if (membership.joined || membership.joining || !membership.wanted || membership.retry_at > now) continue;
    const auto address = directory_.address_of(*multicast::root_of(group));
    if (address && directory_.find(*address)->announced) start_join(group, now);
  }
}

void Engine::Implementation::finish_membership(const Sending& sending, bool delivered, const std::string& reason,
                                               Time now) {
  const auto found = groups_.memberships.find(sending.group);
  if (sending.purpose == Purpose::kLeave || found == groups_.memberships.end()) return;
  multicast::Membership& membership = found->second;
  membership.joining = false;
  membership.joined = delivered && membership.wanted;
  membership.retry_at = now + multicast::Groups::kRetry;
  if (!std::exchange(membership.asked_by_host, false)) return;
  report(GroupChangeFinished{sending.group, true, delivered,
                             delivered ? "" : "cannot join " + sending.group + ": " + reason});
}

void Engine::Implementation::on_group_packet(const std::string& source, const transport::Packet& packet, Time now) {
  const bool own = packet.group == multicast::group_of(self_.name);
  switch (packet.kind) {
    case PacketKind::kGroupJoin:
      if (own) admit_member(source, now);
      return;
    case PacketKind::kGroupLeave:
      if (own) remove_member(source, source + " has left the group", now);
      return;
    case PacketKind::kGroupMembersRequest:
      if (own) answer_members_request(source, packet.group, now);
      return;
    case PacketKind::kGroupMembers:
      if (multicast::group_of(source) != packet.group) return malformed();
      if (const auto members = multicast::decode_members(packet.payload))
        return on_members(packet.group, *members, now);
      return malformed();
    case PacketKind::kGroupCopy:
      return on_copy(source, packet, now);
    case PacketKind::kUser:
      return;
  }
}

/// A member that comes late or comes back is first sent what is still held, by itself; the tree takes it in once it
/// has caught up, so that packets stay in order.
void Engine::Implementation::admit_member(const std::string& name, Time now) {
  const bool known = groups_.members.count(name) != 0;
  if (!known && groups_.members.size() >= multicast::Groups::kMostMembers) return;
  groups_.members[name];
  if (known) return;
  const std::deque<multicast::HeldPacket> held = groups_.held;
  for (const multicast::HeldPacket& packet : held) {
    if (now - packet.sent < multicast::Groups::kHeld) send_copy(name, packet, Purpose::kCatchUp, 0, now);
  }
}

void Engine::Implementation::remove_member(const std::string& name, const std::string& reason, Time now) {
  if (groups_.members.erase(name) == 0) return;
  if (const auto address = directory_.address_of(name)) distributor_.drop_member(*address, reason, now);
}

void Engine::Implementation::send_copy(const std::string& name, const multicast::HeldPacket& packet, Purpose purpose,
                                       SendId parent, Time now) {
  if (const auto member = groups_.members.find(name); member != groups_.members.end()) ++member->second.copies;
  const transport::Image image = transport::encode(
      {PacketKind::kGroupCopy, 0, multicast::group_of(self_.name), {}, multicast::encode_copy(packet)});
  start_unicast(name, image, static_cast<Priority>(packet.stream), {purpose, name, {}, parent, 0}, now);
}

void Engine::Implementation::copy_finished(const std::string& name) {
  const auto member = groups_.members.find(name);
  if (member != groups_.members.end() && member->second.copies > 0) --member->second.copies;
}

void Engine::Implementation::on_copy(const std::string& source, const transport::Packet& packet, Time now) {
  const auto copy = multicast::decode_copy(packet.payload);
  const auto address = directory_.address_of(source);
  if (!copy || !address || packet.group != multicast::group_of(source)) return malformed();
  distributor_.take_copy(*address, directory_.find(*address)->boot, copy->stream, copy->number, copy->image, now);
}

/// What became of packets of the own group at its members.
void Engine::Implementation::finish_group_members(Time now) {
  for (const multicast::MemberEnd& end : distributor_.take_ends()) {
    const routing::Robot* robot = directory_.find(end.member);
    const std::string name = robot != nullptr ? robot->name : "a robot that is gone";
    const auto fan_out = groups_.fan_outs.find(end.id);
    if (end.by_copy && robot != nullptr && fan_out != groups_.fan_outs.end()) {
      send_copy(name, multicast::HeldPacket(fan_out->second.packet), Purpose::kFanOut, end.id, now);
    } else {
      finish_fan_out_part(end.id, name, end.delivered, end.reason, now);
    }
  }
}

void Engine::Implementation::take_group_packets(Time now) {
  for (const multicast::Arrived& arrived : distributor_.take_arrived()) {
    const routing::Robot* robot = directory_.find(arrived.root);
    if (robot != nullptr) deliver_packet(std::string(robot->name), arrived.image, arrived.hops, now);
  }
}

void Engine::Implementation::answer_members_request(const std::string& source, const std::string& group, Time now) {
  std::set<std::string> members{self_.name};
  for (const auto& [name, member] : groups_.members) members.insert(name);
  send_control(source, PacketKind::kGroupMembers, group, multicast::encode_members(members), Purpose::kInternal, now);
}

void Engine::Implementation::on_members(const std::string& group, const std::vector<std::string>& members, Time now) {
  const auto found = groups_.waiting.find(group);
  if (found == groups_.waiting.end()) return;
  const std::vector<multicast::WaitingSend> waiting = std::move(found->second);
  groups_.waiting.erase(found);
  std::vector<std::string> others;
  for (const std::string& member : members) {
    if (member != self_.name) others.push_back(member);
  }
  for (const multicast::WaitingSend& send : waiting) fan_out(send.id, others, send.image, send.priority, now);
}

void Engine::Implementation::expire_waiting_sends(Time now) {
  for (auto iterator = groups_.waiting.begin(); iterator != groups_.waiting.end();) {
    const std::string group = iterator->first;
    if (iterator->second.front().give_up > now) {
      ++iterator;
      continue;
    }
    const std::vector<multicast::WaitingSend> waiting = std::move(iterator->second);
    iterator = groups_.waiting.erase(iterator);
    for (const multicast::WaitingSend& send : waiting) {
      finish(send.id, false,
             *multicast::root_of(group) + " did not name the members of " + group + " within " +
                 seconds_text(multicast::Groups::kMembersPatience),
             now);
    }
  }
}

GroupState Engine::Implementation::group_state(const std::string& group) const {
  GroupState state;
  const auto root = multicast::root_of(group);
  if (root && *root == self_.name) {
    state.known = state.member = state.activated = state.connected = state.root = true;
    for (const auto& [name, member] : groups_.members) state.downlinks.push_back(name);
    return state;
  }
  const auto found = groups_.memberships.find(group);
  if (!root || found == groups_.memberships.end() || !found->second.wanted) return state;
  state.known = true;
  state.member = found->second.joined || found->second.joining;
  state.joining = found->second.joining;
  state.activated = state.connected = found->second.joined;
  const auto address = directory_.address_of(*root);
  const routing::Route* route = address ? router_.route_to(*address, now_) : nullptr;
  if (route != nullptr) {
    const routing::Robot* next = directory_.find(route->next_hop);
    const std::string hops = std::to_string(route->hops);
    state.route_uplink =
        "Next hop:" + (next == nullptr ? *root : next->name) + " RD:" + hops + " HOBS:" + hops + " CH:" + hops;
  }
  return state;
}

}  // namespace adhoc_communication
