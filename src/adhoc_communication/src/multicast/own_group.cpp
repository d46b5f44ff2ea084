#include "multicast/own_group.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication::multicast {

std::vector<std::string> OwnGroup::names() const {
  std::vector<std::string> result;
  for (const auto& [name, member] : members_) result.push_back(name);
  return result;
}

OwnGroup::Admission OwnGroup::admit(const std::string& robot, wire::BootTag boot) {
  const auto known = members_.find(robot);
  if (known == members_.end() && members_.size() >= most_) return Admission::kFull;
  forget_absent(robot);
  if (known == members_.end()) {
    members_.emplace(robot, Member{boot});
    return Admission::kNew;
  }
  if (known->second.boot == boot) return Admission::kKnown;
  known->second = Member{boot};
  return Admission::kRestarted;
}

bool OwnGroup::leave(const std::string& robot) {
  forget_absent(robot);
  return members_.erase(robot) != 0;
}

bool OwnGroup::lose(const std::string& robot, wire::BootTag boot) {
  const auto member = members_.find(robot);
  if (member == members_.end() || member->second.boot != boot) return false;
  members_.erase(member);
  absent_.emplace_back(robot, boot);
  if (absent_.size() > kMostAbsent) absent_.pop_front();
  return true;
}

bool OwnGroup::comes_back(const std::string& robot, wire::BootTag boot) {
  const auto absent = find_absent(robot);
  if (absent == absent_.end()) return false;
  const bool same_run = absent->second == boot;
  absent_.erase(absent);
  return same_run;
}

OwnGroup::Absent::iterator OwnGroup::find_absent(const std::string& robot) {
  return std::find_if(absent_.begin(), absent_.end(), [&](const auto& absent) { return absent.first == robot; });
}

void OwnGroup::forget_absent(const std::string& robot) {
  if (const auto absent = find_absent(robot); absent != absent_.end()) absent_.erase(absent);
}

void OwnGroup::copy_started(const std::string& robot, const HeldPacket& packet) {
  const auto found = members_.find(robot);
  if (found == members_.end()) return;
  found->second.copies.emplace(std::pair(packet.stream, packet.number), packet.sent);
}

void OwnGroup::leave_out(const std::string& robot) {
  const auto found = members_.find(robot);
  if (found == members_.end()) return;
  if (!std::exchange(found->second.left_out, true)) found->second.other_tree = false;
}

void OwnGroup::take_back(const std::string& robot) {
  if (const auto found = members_.find(robot); found != members_.end()) found->second.left_out = false;
}

void OwnGroup::copy_finished(const std::string& robot, std::uint8_t stream, std::uint32_t number) {
  const auto found = members_.find(robot);
  if (found == members_.end()) return;
  Copies& copies = found->second.copies;
  if (const auto copy = copies.find({stream, number}); copy != copies.end()) copies.erase(copy);
  if (copies.empty()) found->second.left_out = false;
}

bool OwnGroup::served_by_copies(const std::string& robot) const {
  const auto member = members_.find(robot);
  return member != members_.end() && member->second.left_out;
}

void OwnGroup::take_back_punctual(Time now) {
  const auto late = [now](const auto& copy) { return now - copy.second >= kPunctual; };
  for (auto& [name, member] : members_) {
    if (!member.left_out || !member.other_tree) continue;
    member.left_out = std::any_of(member.copies.begin(), member.copies.end(), late);
  }
}

void OwnGroup::tree_built() {
  for (auto& [name, member] : members_) member.other_tree = true;
}

void OwnGroup::hold(HeldPacket packet, Time now) {
  held_.push_back(std::move(packet));
  std::size_t octets = 0;
  for (const HeldPacket& kept : held_) octets += kept.image->size();
  while (!held_.empty() &&
         (now - held_.front().sent >= kHeld || held_.size() > kMostHeld || octets > kMostHeldOctets)) {
    octets -= held_.front().image->size();
    held_.pop_front();
  }
}

void OwnGroup::replace_held(const HeldPacket& packet) {
  for (HeldPacket& held : held_) {
    if (held.stream == packet.stream && held.number == packet.number) held = packet;
  }
}

std::vector<HeldPacket> OwnGroup::held_for_newcomers(Time now) const {
  std::vector<HeldPacket> result;
  for (const HeldPacket& packet : held_) {
    if (now - packet.sent < kHeld && now < packet.until) result.push_back(packet);
  }
  return result;
}

}  // namespace adhoc_communication::multicast
