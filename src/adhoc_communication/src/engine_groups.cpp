// Membership of groups.
#include <algorithm>

#include "engine_implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {

using transport::PacketKind;

SendId Engine::Implementation::send_control(const std::string& destination, PacketKind kind, const std::string& group,
                                            Bytes payload, Purpose purpose, Time now) {
  const transport::Image image = transport::encode({kind, 0, group, {}, std::move(payload)});
  return start_unicast(destination, image, Priority::kControl, {purpose, destination, group}, now);
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
  membership.left = false;
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
  if (found->second.asked_by_host) {
    report(GroupChangeFinished{group, true, false, group + " was left before it was joined"});
  }
  // Left at once for this robot; the root hears of it as soon as it can be reached.
  found->second = multicast::Membership{};
  found->second.wanted = false;
  start_leave(group, now);
  report(GroupChangeFinished{group, false, true, {}});
}

void Engine::Implementation::start_join(const std::string& group, Time now) {
  if (groups_.memberships.count(group) == 0 && groups_.memberships.size() >= multicast::Groups::kMostGroups) return;
  multicast::Membership& membership = groups_.memberships[group];
  if (!membership.wanted || membership.joining || membership.joined) return;
  membership.joining = true;
  send_control(*multicast::root_of(group), PacketKind::kGroupJoin, group, {}, Purpose::kJoin, now);
}

/// Joins and leaves that have not reached the root are tried again while it is known.
void Engine::Implementation::settle_memberships(Time now) {
  std::vector<std::string> unconfirmed;
  for (auto& [group, membership] : groups_.memberships) {
    if (membership.confirmed_by && *membership.confirmed_by <= now) unconfirmed.push_back(group);
    const bool settled =
        membership.wanted ? membership.joined || membership.joining : membership.leaving || membership.left;
    if (settled || membership.retry_at > now) continue;
    const auto address = directory_.address_of(*multicast::root_of(group));
    if (!address || !directory_.find(*address)->announced) continue;
    if (membership.wanted) {
      start_join(group, now);
    } else {
      start_leave(group, now);
    }
  }
  for (const std::string& group : unconfirmed) {
    end_join(group, "the root did not answer within " + seconds_text(multicast::Groups::kMembersPatience), now);
  }
}

void Engine::Implementation::start_leave(const std::string& group, Time now) {
  groups_.memberships[group].leaving = true;
  send_control(*multicast::root_of(group), PacketKind::kGroupLeave, group, {}, Purpose::kLeave, now);
}

void Engine::Implementation::finish_membership(const Sending& sending, bool delivered, const std::string& reason,
                                               Time now) {
  const auto found = groups_.memberships.find(sending.group);
  if (found == groups_.memberships.end()) return;
  multicast::Membership& membership = found->second;
  membership.retry_at = now + multicast::Groups::kRetry;
  if (sending.purpose == Purpose::kLeave) {
    membership.leaving = false;
    membership.left = delivered && !membership.wanted;
    if (membership.left && !options_.join_groups_automatically) groups_.memberships.erase(found);
    return;
  }
  membership.joining = false;
  membership.joined = delivered && membership.wanted && !membership.turned_away;
  if (std::exchange(membership.turned_away, false)) membership.retry_at = now + multicast::Groups::kFullRetry;
  if (!membership.asked_by_host) return;
  if (!delivered) return end_join(sending.group, reason, now);
  membership.confirmed_by = now + multicast::Groups::kMembersPatience;
  send_control(*multicast::root_of(sending.group), PacketKind::kGroupMembersRequest, sending.group, {},
               Purpose::kConfirmation, now);
}

/// A join that the host has asked for has come to its end. When it has failed it is over, but for what happens by
/// itself.
void Engine::Implementation::end_join(const std::string& group, const std::string& failure, Time now) {
  const auto found = groups_.memberships.find(group);
  if (found == groups_.memberships.end() || !found->second.asked_by_host) return;
  found->second.asked_by_host = false;
  found->second.confirmed_by.reset();
  if (failure.empty()) return report(GroupChangeFinished{group, true, true, {}});
  const bool known = directory_.address_of(*multicast::root_of(group)).has_value();
  found->second.joined = false;
  found->second.retry_at = std::max(found->second.retry_at, now + multicast::Groups::kRetry);
  if (!options_.join_groups_automatically || !known) groups_.memberships.erase(found);
  report(GroupChangeFinished{group, true, false, "cannot join " + group + ": " + failure});
}

/// The root does not count this robot among its members.
void Engine::Implementation::turned_away(const std::string& group, std::size_t members, Time now) {
  const auto found = groups_.memberships.find(group);
  if (found == groups_.memberships.end() || !found->second.wanted) return;
  found->second.turned_away = found->second.joining;
  if (found->second.joining) return;
  const bool full = members >= most_members();
  found->second.joined = false;
  found->second.retry_at = now + (full ? multicast::Groups::kFullRetry : Time(0));
  end_join(group,
           full ? "it is full (" + std::to_string(members) + " members)" : "its root does not take this robot in", now);
}

void Engine::Implementation::on_group_packet(const std::string& source, const transport::Packet& packet, Time now) {
  const bool own = packet.group == multicast::group_of(self_.name);
  switch (packet.kind) {
    case PacketKind::kGroupJoin:
      if (own) admit_member(source, now);
      return;
    case PacketKind::kGroupLeave:
      if (own) groups_.absent.erase(source);
      if (own) remove_member(source, source + " has left the group", now);
      return;
    case PacketKind::kGroupMembersRequest:
      if (own) send_members(source, now);
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

/// All of them fit one activation.
std::size_t Engine::Implementation::most_members() const {
  const std::size_t room =
      static_cast<std::size_t>(options_.mtu) - wire::kHeaderSize - wire::kTagSize - wire::kActivationHeaderSize;
  return std::min(multicast::Groups::kMostMembers, room / MacAddress{}.size());
}

/// A member that comes late or comes back is first sent what is still held, by itself; the tree takes it in once it
/// has caught up, so that packets stay in order.
void Engine::Implementation::admit_member(const std::string& name, Time now) {
  const bool known = groups_.members.count(name) != 0;
  if (!known && groups_.members.size() >= most_members()) return send_members(name, now);
  groups_.members[name];
  groups_.absent.erase(name);
  if (known) return;
  const std::deque<multicast::HeldPacket> held = groups_.held;
  for (const multicast::HeldPacket& packet : held) {
    const bool of_use = now - packet.sent < multicast::Groups::kHeld && now < packet.until;
    if (of_use) send_copy(name, packet, Purpose::kCatchUp, 0, now);
  }
}

/// A member that falls silent stays one as long as it runs: it need not have noticed.
void Engine::Implementation::member_lost(const std::string& name, wire::BootTag boot, Time now) {
  if (groups_.members.count(name) == 0) return;
  if (groups_.absent.size() < multicast::Groups::kMostMembers) groups_.absent[name] = boot;
  remove_member(name, name + " was lost", now);
}

void Engine::Implementation::member_returned(const std::string& name, wire::BootTag boot, Time now) {
  const auto absent = groups_.absent.find(name);
  if (absent == groups_.absent.end()) return;
  const bool same_run = absent->second == boot;
  groups_.absent.erase(absent);
  if (same_run) admit_member(name, now);
}

void Engine::Implementation::remove_member(const std::string& name, const std::string& reason, Time now) {
  if (groups_.members.erase(name) == 0) return;
  if (const auto address = directory_.address_of(name)) distributor_.drop_member(*address, reason, now);
}

void Engine::Implementation::send_copy(const std::string& name, const multicast::HeldPacket& packet, Purpose purpose,
                                       SendId parent, Time now) {
  if (const auto member = groups_.members.find(name); member != groups_.members.end()) ++member->second.copies;
  const transport::Image image = transport::image_of(  // what it carries is packed
      {PacketKind::kGroupCopy, 0, multicast::group_of(self_.name), {}, multicast::encode_copy(packet)});
  distributor_.copy_started(packet.stream, packet.number);
  Sending sending{purpose, name, {}, parent};
  sending.copy.emplace(packet.stream, packet.number);
  start_unicast(name, image, static_cast<Priority>(packet.stream), std::move(sending), now);
}

void Engine::Implementation::copy_finished(const Sending& copy) {
  if (copy.copy) distributor_.copy_finished(copy.copy->first, copy.copy->second);
  const auto member = groups_.members.find(copy.destination);
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
    const std::string name = name_or_address(end.member);
    const auto fan_out = groups_.fan_outs.find(end.id);
    if (end.by_copy && robot != nullptr && fan_out != groups_.fan_outs.end()) {
      send_copy(name, multicast::HeldPacket(fan_out->second.packet), Purpose::kFanOut, end.id, now);
    } else {
      finish_fan_out_part(end.id, name, end.delivered, end.reason, now);
    }
  }
}

bool Engine::Implementation::takes_part(const MacAddress& root) const {
  const routing::Robot* robot = directory_.find(root);
  if (robot == nullptr) return false;
  const auto found = groups_.memberships.find(multicast::group_of(robot->name));
  return found != groups_.memberships.end() && !found->second.left;
}

void Engine::Implementation::take_group_packets(Time now) {
  for (const multicast::Arrived& arrived : distributor_.take_arrived()) {
    if (!takes_part(arrived.root)) continue;
    deliver_packet(Carrier::kGroup, std::string(directory_.find(arrived.root)->name), arrived.image, arrived.hops, now);
  }
}

/// Who does not find its name there is none.
void Engine::Implementation::send_members(const std::string& robot, Time now) {
  std::set<std::string> members{self_.name};
  for (const auto& [name, member] : groups_.members) members.insert(name);
  send_control(robot, PacketKind::kGroupMembers, multicast::group_of(self_.name), multicast::encode_members(members),
               Purpose::kInternal, now);
}

void Engine::Implementation::on_members(const std::string& group, const std::vector<std::string>& members, Time now) {
  if (std::find(members.begin(), members.end(), self_.name) == members.end()) {
    turned_away(group, members.empty() ? 0 : members.size() - 1, now);
  } else {
    end_join(group, {}, now);
  }
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

void Engine::Implementation::request_members(const std::string& group, Time now) {
  send_control(*multicast::root_of(group), PacketKind::kGroupMembersRequest, group, {}, Purpose::kMembersRequest, now);
}

void Engine::Implementation::fail_waiting_sends(const std::string& group, const std::string& reason, Time now) {
  const auto waiting = groups_.waiting.extract(group);
  if (!waiting) return;
  for (const multicast::WaitingSend& send : waiting.mapped()) {
    finish(send.id, false, "cannot learn the members of " + group + ": " + reason, now);
  }
}

/// Each send has its own patience; for those that came later the root is asked again.
void Engine::Implementation::expire_waiting_sends(Time now) {
  std::vector<SendId> expired;
  std::vector<std::string> to_ask;
  for (auto& [group, waiting] : groups_.waiting) {
    const std::size_t before = expired.size();
    for (const multicast::WaitingSend& send : waiting) {
      if (send.give_up <= now) expired.push_back(send.id);
    }
    if (expired.size() == before) continue;
    waiting.erase(std::remove_if(waiting.begin(), waiting.end(), [&](const auto& send) { return send.give_up <= now; }),
                  waiting.end());
    if (!waiting.empty()) to_ask.push_back(group);
  }
  for (auto iterator = groups_.waiting.begin(); iterator != groups_.waiting.end();) {
    iterator = iterator->second.empty() ? groups_.waiting.erase(iterator) : std::next(iterator);
  }
  for (const SendId id : expired) {
    finish(id, false,
           "the root of the group did not name its members within " + seconds_text(multicast::Groups::kMembersPatience),
           now);
  }
  for (const std::string& group : to_ask) request_members(group, now);
}

/// The children in the tree, and for members that no packet has made part of it yet the neighbours that will be.
std::set<MacAddress> Engine::Implementation::ways_to_members() const {
  const auto found = distributor_.trees().find(self_.address);
  const multicast::Tree* tree = found == distributor_.trees().end() ? nullptr : &found->second;
  std::set<MacAddress> ways;
  for (const auto& [name, member] : groups_.members) {
    const auto address = directory_.address_of(name);
    if (!address || (tree != nullptr && tree->holds(*address))) continue;
    if (const routing::Route* route = router_.route_to(*address, now_)) ways.insert(route->next_hop);
  }
  if (tree != nullptr) ways.merge(tree->child_addresses());
  return ways;
}

GroupState Engine::Implementation::group_state(const std::string& group) const {
  GroupState state;
  const auto root = multicast::root_of(group);
  if (root && *root == self_.name) {
    state.known = state.member = state.activated = state.connected = state.root = true;
    for (const auto& [name, member] : groups_.members) state.members.push_back(name);
    for (const MacAddress& neighbor : ways_to_members()) state.downlinks.push_back(name_or_address(neighbor));
    return state;
  }
  if (!root) return state;
  const auto address = directory_.address_of(*root);
  const auto tree = address ? distributor_.trees().find(*address) : distributor_.trees().end();
  const bool on_tree = tree != distributor_.trees().end() && tree->second.upstream;
  const auto found = groups_.memberships.find(group);
  const bool wanted = found != groups_.memberships.end() && found->second.wanted;
  if (!wanted && !on_tree) return state;
  state.known = true;
  if (wanted) {
    state.member = found->second.joined || found->second.joining;
    state.joining = found->second.joining;
  }
  state.activated = state.connected = on_tree || (wanted && found->second.joined);
  const routing::Route* route = address ? router_.route_to(*address, now_) : nullptr;
  if (on_tree) {
    for (const auto& [child, members] : tree->second.children) state.downlinks.push_back(name_or_address(child));
  }
  if (!on_tree && route == nullptr) return state;
  const std::string hops = std::to_string(route == nullptr ? 1 : route->hops);
  state.route_uplink = "Next hop:" + name_or_address(on_tree ? *tree->second.upstream : route->next_hop) +
                       " RD:" + hops + " HOBS:" + hops + " CH:" + hops;
  return state;
}

}  // namespace adhoc_communication
