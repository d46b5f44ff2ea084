// The own group: its members, and packets for them.
#include <algorithm>

#include "multicast/group_traffic.hpp"
#include "routing/names.hpp"

namespace adhoc_communication::multicast {

using transport::Image;
using transport::PacketKind;
using transport::Purpose;
using transport::Sending;

namespace {

Time end_of(Time lifetime, Time now) { return lifetime > Time(0) ? now + lifetime : Time::max(); }

}  // namespace

/// Along the tree, but for members that are being sent packets by themselves.
void GroupTraffic::send_to_own(SendId id, const Image& image, Priority priority, Time lifetime, Time now) {
  std::set<MacAddress> on_tree;
  std::vector<std::string> by_themselves;
  const bool flooded = floods(image->size(), priority);
  if (distributor_.builds_anew()) own_group_.tree_built();
  own_group_.take_back_punctual(now);
  for (const std::string& name : own_group_.names()) {
    const auto address = directory_.address_of(name);
    if (flooded && address) own_group_.take_back(name);
    if (address && !own_group_.served_by_copies(name)) {
      on_tree.insert(*address);
    } else {
      by_themselves.push_back(name);
    }
  }
  const std::uint32_t number = flooded && !on_tree.empty() ? distributor_.flood(id, priority, image, on_tree, now)
                                                           : distributor_.start(id, priority, image, on_tree, now);
  const HeldPacket packet{static_cast<std::uint8_t>(priority), number, image, now, end_of(lifetime, now)};
  own_group_.hold(packet, now);
  if (own_group_.size() == 0) return ends_.push_back({id, true, {}});
  sends_.fan_out(id, own_group_.size(), packet);
  for (const std::string& name : by_themselves) {
    own_group_.leave_out(name);
    send_copy(name, packet, Purpose::kFanOut, id);
  }
}

bool GroupTraffic::floods(std::size_t octets, Priority priority) const {
  const std::vector<std::string> members = own_group_.names();
  const auto is_far = [this](const std::string& member) {
    const auto address = directory_.address_of(member);
    const routing::Robot* robot = address ? directory_.find(*address) : nullptr;
    return robot != nullptr && robot->hops > 1;
  };
  const auto far_members = static_cast<std::size_t>(std::count_if(members.begin(), members.end(), is_far));
  return distributor_.floods(octets, priority, members.size(), far_members, directory_.size());
}

bool GroupTraffic::replace_in_own(SendId former, SendId id, const Image& image, Time lifetime, Time now) {
  std::set<MacAddress> members;
  for (const std::string& name : own_group_.names()) {
    const auto address = directory_.address_of(name);
    if (!address) return false;
    members.insert(*address);
  }
  const auto number = distributor_.replace(former, id, image, members, now);
  if (!number) return false;
  const HeldPacket packet{sends_.packet_of(former).stream, *number, image, now, end_of(lifetime, now)};
  sends_.replace(former, id, packet);
  own_group_.replace_held(packet);
  return true;
}

/// A member that comes late or comes back is first sent what is still held, by itself; the tree takes it in once it
/// has caught up, so that packets stay in order.
void GroupTraffic::admit(const std::string& robot, wire::BootTag boot, bool was_away, Time now) {
  const auto admission = own_group_.admit(robot, boot);
  if (admission == OwnGroup::Admission::kFull) return name_members(robot);
  if (admission == OwnGroup::Admission::kKnown) return;
  if (admission == OwnGroup::Admission::kRestarted) leave_out(robot, robot + " has restarted", now);
  const auto address = directory_.address_of(robot);
  if (address && !was_away) distributor_.forget_receipts(*address);
  for (const HeldPacket& packet : own_group_.held_for_newcomers(now)) {
    const bool has_it = address && distributor_.has_delivered(*address, packet.stream, packet.number);
    if (has_it) continue;
    own_group_.leave_out(robot);
    send_copy(robot, packet, Purpose::kCatchUp, 0);
  }
}

/// It is no member any more.
void GroupTraffic::leave_out(const std::string& robot, const std::string& reason, Time now) {
  if (const auto address = directory_.address_of(robot)) distributor_.drop_member(*address, reason, now);
}

void GroupTraffic::name_members(const std::string& robot) {
  std::set<std::string> members{self_.name};
  for (const std::string& name : own_group_.names()) members.insert(name);
  write({Purpose::kInternal, robot, group_of(self_.name)}, PacketKind::kGroupMembers, encode_members(members));
}

void GroupTraffic::send_copy(const std::string& robot, const HeldPacket& packet, Purpose purpose, SendId parent) {
  own_group_.copy_started(robot, packet);
  distributor_.copy_started(packet.stream, packet.number);
  copies_.add({robot, packet, purpose, parent});
  start_copies();
}

void GroupTraffic::start_copies() {
  while (const auto copy = copies_.next()) {
    if (has_arrived(*copy)) {
      drop_copy(*copy);
      continue;
    }
    Image image = transport::image_of(  // what it carries is packed
        {PacketKind::kGroupCopy, 0, group_of(self_.name), {}, encode_copy(copy->packet)});
    Sending sending{copy->purpose, copy->member, {}, copy->parent};
    sending.copy.emplace(copy->packet.stream, copy->packet.number);
    sending.priority = static_cast<Priority>(copy->packet.stream);
    letters_.push_back({std::move(sending), std::move(image)});
  }
}

/// By a flood, while the copy waited for its turn.
bool GroupTraffic::has_arrived(const WaitingCopy& copy) const {
  const auto address = directory_.address_of(copy.member);
  return address && distributor_.has_delivered(*address, copy.packet.stream, copy.packet.number);
}

void GroupTraffic::drop_copy(const WaitingCopy& copy) {
  copy_ended(copy.member, copy.packet.stream, copy.packet.number);
  copies_.finished(copy.member, copy.packet.stream);
  if (copy.purpose == Purpose::kFanOut) part_finished(copy.parent, copy.member, true, {});
}

void GroupTraffic::copy_ended(const std::string& member, std::uint8_t stream, std::uint32_t number) {
  distributor_.copy_finished(stream, number);
  own_group_.copy_finished(member, stream, number);
}

void GroupTraffic::copy_finished(const Sending& copy) {
  if (!copy.copy) return;
  copy_ended(copy.destination, copy.copy->first, copy.copy->second);
  copies_.finished(copy.destination, copy.copy->first);
  start_copies();
}

void GroupTraffic::take_member_ends() {
  for (const MemberEnd& end : distributor_.take_ends()) {
    const std::string name = routing::name_or_address(self_, directory_, end.member);
    if (end.by_copy && directory_.find(end.member) != nullptr && sends_.fans_out(end.id)) {
      if (!end.by_flood) own_group_.leave_out(name);
      send_copy(name, sends_.packet_of(end.id), Purpose::kFanOut, end.id);
    } else {
      part_finished(end.id, name, end.delivered, end.reason);
    }
  }
}

}  // namespace adhoc_communication::multicast
