// A member's side.
#include "multicast/group_traffic.hpp"

#include <algorithm>

#include "routing/names.hpp"
#include "texts.hpp"

namespace adhoc_communication::multicast {

using transport::Image;
using transport::PacketKind;
using transport::Purpose;
using transport::Sending;

namespace {

PacketKind kind_of(Word::Kind word) {
  switch (word) {
    case Word::Kind::kJoin:
      return PacketKind::kGroupJoin;
    case Word::Kind::kLeave:
      return PacketKind::kGroupLeave;
    case Word::Kind::kConfirmation:
      break;
  }
  return PacketKind::kGroupMembersRequest;
}

Word::Kind word_of(PacketKind kind) {
  if (kind == PacketKind::kGroupJoin) return Word::Kind::kJoin;
  return kind == PacketKind::kGroupLeave ? Word::Kind::kLeave : Word::Kind::kConfirmation;
}

std::string no_group_text(const std::string& words) {
  return "'" + escaped(words) + "' is not the name of a group (mc_<robot>)";
}

}  // namespace

void GroupTraffic::write(Sending sending, PacketKind kind, Bytes payload) {
  sending.priority = Priority::kControl;
  Image image = transport::encode({kind, 0, sending.group, {}, std::move(payload)});
  letters_.push_back({std::move(sending), std::move(image)});
}

void GroupTraffic::join(const std::string& group) {
  const auto root = root_of(group);
  if (!root) return changes_.push_back({group, true, false, no_group_text(group)});
  if (*root == self_.name) return changes_.push_back({group, true, true, {}});
  if (!wire::is_name(*root)) return changes_.push_back({group, true, false, no_name_text(*root)});
  memberships_.join(group);
  carry_out_memberships();
}

void GroupTraffic::leave(const std::string& group) {
  if (!root_of(group)) return changes_.push_back({group, false, false, no_group_text(group)});
  if (group == group_of(self_.name)) {
    return changes_.push_back({group, false, false, "the root cannot leave its own group " + group});
  }
  memberships_.leave(group);
  carry_out_memberships();
}

void GroupTraffic::carry_out_memberships() {
  for (const Word& word : memberships_.take_words()) {
    Sending sending{Purpose::kWord, *root_of(word.group), word.group};
    sending.word = kind_of(word.kind);
    write(std::move(sending), kind_of(word.kind), {});
  }
  for (GroupChangeFinished& end : memberships_.take_ends()) changes_.push_back(std::move(end));
}

void GroupTraffic::send(SendId id, const std::string& group, const Image& image, Priority priority, Time lifetime,
                        Time now) {
  if (group == group_of(self_.name)) return send_to_own(id, image, priority, lifetime, now);
  if (!memberships_.joined(group)) return ends_.push_back({id, false, "this robot is not a member of " + group});
  if (sends_.wait(group, {id, image, priority, now + Memberships::kMembersPatience})) ask_for_members(group);
}

bool GroupTraffic::replace(SendId former, SendId id, const std::string& group, const Image& image, Time lifetime,
                           Time now) {
  if (group == group_of(self_.name)) return replace_in_own(former, id, image, lifetime, now);
  return sends_.replace_waiting(group, former, id, image);
}

std::vector<std::string> GroupTraffic::cancel(SendId id, const std::string& group) {
  sends_.drop_waiting(group, id);
  sends_.drop(id);
  std::vector<std::string> missed;
  for (const MacAddress& member : distributor_.drop(id)) {
    missed.push_back(routing::name_or_address(self_, directory_, member));
  }
  for (const WaitingCopy& copy : copies_.drop(id)) {
    copy_ended(copy.member, copy.packet.stream, copy.packet.number);
    missed.push_back(copy.member);
  }
  return missed;
}

void GroupTraffic::appeared(const std::string& robot, wire::BootTag boot, Time now) {
  if (own_group_.comes_back(robot, boot)) admit(robot, boot, true, now);
  memberships_.appeared(robot, now);
  carry_out_memberships();
}

void GroupTraffic::lost(const std::string& robot, wire::BootTag boot, Time now) {
  if (own_group_.lose(robot, boot)) leave_out(robot, robot + " was lost", now);
  memberships_.lost(robot);
}

bool GroupTraffic::take(const std::string& source, wire::BootTag boot, const transport::Packet& packet, Time now) {
  const bool own = packet.group == group_of(self_.name);
  switch (packet.kind) {
    case PacketKind::kGroupJoin:
      if (own) admit(source, boot, false, now);
      return true;
    case PacketKind::kGroupLeave:
      if (own && own_group_.leave(source)) leave_out(source, source + " has left the group", now);
      return true;
    case PacketKind::kGroupMembersRequest:
      if (own) name_members(source);
      return true;
    case PacketKind::kGroupMembers: {
      const auto members = decode_members(packet.payload);
      if (group_of(source) != packet.group || !members) return false;
      members_named(packet.group, *members, now);
      return true;
    }
    case PacketKind::kGroupCopy:
      return take_copy(source, packet, now);
    case PacketKind::kUser:
      break;
  }
  return true;
}

bool GroupTraffic::take_copy(const std::string& source, const transport::Packet& packet, Time now) {
  const auto copy = decode_copy(packet.payload);
  const auto address = directory_.address_of(source);
  if (!copy || !address || packet.group != group_of(source)) return false;
  distributor_.take_copy(*address, directory_.find(*address)->boot, copy->stream, copy->number, copy->image, now);
  return true;
}

/// Who does not find its name there is none.
void GroupTraffic::members_named(const std::string& group, const std::vector<std::string>& members, Time now) {
  const bool this_robot = std::find(members.begin(), members.end(), self_.name) != members.end();
  memberships_.named(group, this_robot, members.empty() ? 0 : members.size() - 1, now);
  carry_out_memberships();
  std::vector<std::string> others;
  for (const std::string& member : members) {
    if (member != self_.name) others.push_back(member);
  }
  for (const WaitingSend& send : sends_.take_waiting(group)) send_to_each(send, others);
}

void GroupTraffic::send_to_each(const WaitingSend& send, const std::vector<std::string>& members) {
  if (members.empty()) return ends_.push_back({send.id, true, {}});
  sends_.fan_out(send.id, members.size());
  for (const std::string& member : members) {
    Sending sending{Purpose::kFanOut, member, {}, send.id};
    sending.priority = send.priority;
    letters_.push_back({std::move(sending), send.image});
  }
}

void GroupTraffic::ask_for_members(const std::string& group) {
  write({Purpose::kMembersRequest, *root_of(group), group}, PacketKind::kGroupMembersRequest, {});
}

void GroupTraffic::fail_waiting(const std::string& group, const std::string& reason) {
  for (const WaitingSend& send : sends_.take_waiting(group)) {
    ends_.push_back({send.id, false, "cannot learn the members of " + group + ": " + reason});
  }
}

void GroupTraffic::ended(const Sending& letter, bool delivered, const std::string& reason, Time now) {
  if (delivered && letter.copy) {
    const auto address = directory_.address_of(letter.destination);
    if (address) distributor_.copy_arrived(*address, letter.copy->first, letter.copy->second, now);
  }
  switch (letter.purpose) {
    case Purpose::kFanOut:
      copy_finished(letter);
      return part_finished(letter.parent, letter.destination, delivered, reason);
    case Purpose::kCatchUp:
      return copy_finished(letter);
    case Purpose::kMembersRequest:
      if (!delivered) fail_waiting(letter.group, reason);
      return;
    case Purpose::kWord:
      memberships_.said({word_of(letter.word), letter.group}, delivered, reason, now);
      return carry_out_memberships();
    case Purpose::kHost:
    case Purpose::kInternal:
      return;
  }
}

void GroupTraffic::part_finished(SendId parent, const std::string& member, bool delivered, const std::string& reason) {
  const auto missed = sends_.part_finished(parent, member, delivered, reason);
  if (!missed) return;
  const bool all = missed->members.empty();
  ends_.push_back({parent, all, all ? "" : "not delivered to " + missed->text, missed->members});
}

void GroupTraffic::expire(Time now) {
  const GroupSends::Overdue overdue = sends_.take_overdue(now);
  for (const SendId id : overdue.sends) {
    const std::string patience = seconds_text(Memberships::kMembersPatience);
    ends_.push_back({id, false, "the root of the group did not name its members within " + patience});
  }
  for (const std::string& group : overdue.groups_to_ask) ask_for_members(group);
  own_group_.lose_if([this](const std::string& robot) { return !directory_.address_of(robot); });
  memberships_.expire(now);
  carry_out_memberships();
}

bool GroupTraffic::takes_part(const MacAddress& root) const {
  const routing::Robot* robot = directory_.find(root);
  return robot != nullptr && memberships_.takes_part(group_of(robot->name));
}

bool GroupTraffic::is_member_of(const MacAddress& root) const {
  const routing::Robot* robot = directory_.find(root);
  return robot != nullptr && memberships_.joined(group_of(robot->name));
}

void GroupTraffic::end(const std::string& reason) {
  memberships_.end(reason);
  carry_out_memberships();
}

}  // namespace adhoc_communication::multicast
