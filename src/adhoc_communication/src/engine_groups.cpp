// Membership of groups.
#include <algorithm>

#include "engine_implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {

using transport::PacketKind;

namespace {

PacketKind kind_of(multicast::Word::Kind word) {
  switch (word) {
    case multicast::Word::Kind::kJoin:
      return PacketKind::kGroupJoin;
    case multicast::Word::Kind::kLeave:
      return PacketKind::kGroupLeave;
    case multicast::Word::Kind::kConfirmation:
      break;
  }
  return PacketKind::kGroupMembersRequest;
}

}  // namespace

void Engine::Implementation::send_control(Sending sending, PacketKind kind, Bytes payload, Time now) {
  const transport::Image image = transport::encode({kind, 0, sending.group, {}, std::move(payload)});
  const std::string destination = sending.destination;
  start_unicast(destination, image, Priority::kControl, std::move(sending), now);
}

void Engine::Implementation::join_group(const std::string& group, Time now) {
  touch(now);
  const auto root = multicast::root_of(group);
  if (!root) return report(GroupChangeFinished{group, true, false, group + " is not the name of a group (mc_<robot>)"});
  if (*root == self_.name) return report(GroupChangeFinished{group, true, true, {}});
  memberships_.join(group);
  carry_out_memberships(now);
}

void Engine::Implementation::leave_group(const std::string& group, Time now) {
  touch(now);
  if (group == multicast::group_of(self_.name)) {
    return report(GroupChangeFinished{group, false, false, "the root cannot leave its own group " + group});
  }
  memberships_.leave(group);
  carry_out_memberships(now);
}

void Engine::Implementation::carry_out_memberships(Time now) {
  for (const multicast::Word& word : memberships_.take_words()) {
    Sending sending{Purpose::kWord, *multicast::root_of(word.group), word.group};
    sending.word = word.kind;
    send_control(std::move(sending), kind_of(word.kind), {}, now);
  }
  for (GroupChangeFinished& end : memberships_.take_ends()) report(std::move(end));
}

void Engine::Implementation::on_group_packet(const std::string& source, const transport::Packet& packet, Time now) {
  const bool own = packet.group == multicast::group_of(self_.name);
  switch (packet.kind) {
    case PacketKind::kGroupJoin:
      if (own) admit_member(source, now);
      return;
    case PacketKind::kGroupLeave:
      if (own && own_group_.leave(source)) leave_out(source, source + " has left the group", now);
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

/// A member that comes late or comes back is first sent what is still held, by itself; the tree takes it in once it
/// has caught up, so that packets stay in order.
void Engine::Implementation::admit_member(const std::string& name, Time now) {
  const auto admission = own_group_.admit(name);
  if (admission == multicast::OwnGroup::Admission::kFull) return send_members(name, now);
  if (admission == multicast::OwnGroup::Admission::kKnown) return;
  for (const multicast::HeldPacket& packet : own_group_.held_for_newcomers(now)) {
    send_copy(name, packet, Purpose::kCatchUp, 0, now);
  }
}

/// It is no member any more.
void Engine::Implementation::leave_out(const std::string& name, const std::string& reason, Time now) {
  if (const auto address = directory_.address_of(name)) distributor_.drop_member(*address, reason, now);
}

void Engine::Implementation::send_copy(const std::string& name, const multicast::HeldPacket& packet, Purpose purpose,
                                       SendId parent, Time now) {
  own_group_.copy_started(name);
  const transport::Image image = transport::image_of(  // what it carries is packed
      {PacketKind::kGroupCopy, 0, multicast::group_of(self_.name), {}, multicast::encode_copy(packet)});
  distributor_.copy_started(packet.stream, packet.number);
  Sending sending{purpose, name, {}, parent};
  sending.copy.emplace(packet.stream, packet.number);
  start_unicast(name, image, static_cast<Priority>(packet.stream), std::move(sending), now);
}

void Engine::Implementation::copy_finished(const Sending& copy) {
  if (!copy.copy) return;
  distributor_.copy_finished(copy.copy->first, copy.copy->second);
  own_group_.copy_finished(copy.destination);
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
    if (end.by_copy && robot != nullptr && group_sends_.fans_out(end.id)) {
      send_copy(name, group_sends_.packet_of(end.id), Purpose::kFanOut, end.id, now);
    } else {
      finish_fan_out_part(end.id, name, end.delivered, end.reason, now);
    }
  }
}

bool Engine::Implementation::takes_part(const MacAddress& root) const {
  const routing::Robot* robot = directory_.find(root);
  return robot != nullptr && memberships_.takes_part(multicast::group_of(robot->name));
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
  for (const std::string& name : own_group_.names()) members.insert(name);
  send_control({Purpose::kInternal, robot, multicast::group_of(self_.name)}, PacketKind::kGroupMembers,
               multicast::encode_members(members), now);
}

void Engine::Implementation::on_members(const std::string& group, const std::vector<std::string>& members, Time now) {
  const bool this_robot = std::find(members.begin(), members.end(), self_.name) != members.end();
  memberships_.named(group, this_robot, members.empty() ? 0 : members.size() - 1, now);
  carry_out_memberships(now);
  std::vector<std::string> others;
  for (const std::string& member : members) {
    if (member != self_.name) others.push_back(member);
  }
  for (const multicast::WaitingSend& send : group_sends_.take_waiting(group))
    fan_out(send.id, others, send.image, send.priority, now);
}

void Engine::Implementation::request_members(const std::string& group, Time now) {
  send_control({Purpose::kMembersRequest, *multicast::root_of(group), group}, PacketKind::kGroupMembersRequest, {},
               now);
}

void Engine::Implementation::fail_waiting_sends(const std::string& group, const std::string& reason, Time now) {
  for (const multicast::WaitingSend& send : group_sends_.take_waiting(group)) {
    finish(send.id, false, "cannot learn the members of " + group + ": " + reason, now);
  }
}

void Engine::Implementation::expire_waiting_sends(Time now) {
  const multicast::GroupSends::Overdue overdue = group_sends_.take_overdue(now);
  for (const SendId id : overdue.sends) {
    finish(id, false,
           "the root of the group did not name its members within " +
               seconds_text(multicast::Memberships::kMembersPatience),
           now);
  }
  for (const std::string& group : overdue.groups_to_ask) request_members(group, now);
}

const multicast::Tree* Engine::Implementation::tree_of(const MacAddress& root) const {
  const auto found = distributor_.branches().find(root);
  return found == distributor_.branches().end() ? nullptr : &found->second.tree;
}

/// The children in the tree, and for members that no packet has made part of it yet the neighbours that will be.
std::set<MacAddress> Engine::Implementation::ways_to_members() const {
  const multicast::Tree* tree = tree_of(self_.address);
  std::set<MacAddress> ways;
  for (const std::string& name : own_group_.names()) {
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
    state.members = own_group_.names();
    for (const MacAddress& neighbor : ways_to_members()) state.downlinks.push_back(name_or_address(neighbor));
    return state;
  }
  if (!root) return state;
  const auto address = directory_.address_of(*root);
  const multicast::Tree* tree = address ? tree_of(*address) : nullptr;
  const bool on_tree = tree != nullptr && tree->upstream;
  const multicast::Membership* membership = memberships_.find(group);
  const bool wanted = membership != nullptr && membership->wanted;
  if (!wanted && !on_tree) return state;
  state.known = true;
  if (wanted) {
    state.member = membership->joined;
    state.joining = membership->joining;
  }
  state.activated = state.connected = on_tree || (wanted && membership->joined);
  const routing::Route* route = address ? router_.route_to(*address, now_) : nullptr;
  if (on_tree) {
    for (const auto& [child, members] : tree->children) state.downlinks.push_back(name_or_address(child));
  }
  if (!on_tree && route == nullptr) return state;
  const std::string hops = std::to_string(route == nullptr ? 1 : route->hops);
  state.route_uplink = "Next hop:" + name_or_address(on_tree ? *tree->upstream : route->next_hop) + " RD:" + hops +
                       " HOBS:" + hops + " CH:" + hops;
  return state;
}

}  // namespace adhoc_communication
