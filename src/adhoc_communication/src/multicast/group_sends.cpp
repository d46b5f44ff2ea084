#include "multicast/group_sends.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {

bool GroupSends::wait(const std::string& group, WaitingSend send) {
  std::vector<WaitingSend>& waiting = waiting_[group];
  waiting.push_back(std::move(send));
  return waiting.size() == 1;
}

std::vector<WaitingSend> GroupSends::take_waiting(const std::string& group) {
  auto waiting = waiting_.extract(group);
  return waiting ? std::move(waiting.mapped()) : std::vector<WaitingSend>{};
}

bool GroupSends::replace_waiting(const std::string& group, SendId former, SendId id, const transport::Image& image) {
  const auto sends = waiting_.find(group);
  if (sends == waiting_.end()) return false;
  for (WaitingSend& send : sends->second) {
    if (send.id != former) continue;
    send.id = id;
    send.image = image;
    return true;
  }
  return false;
}

void GroupSends::drop_waiting(const std::string& group, SendId id) {
  const auto sends = waiting_.find(group);
  if (sends == waiting_.end()) return;
  auto& all = sends->second;
  all.erase(std::remove_if(all.begin(), all.end(), [id](const WaitingSend& send) { return send.id == id; }), all.end());
  if (all.empty()) waiting_.erase(sends);
}

GroupSends::Overdue GroupSends::take_overdue(Time now) {
  Overdue overdue;
  for (auto item = waiting_.begin(); item != waiting_.end();) {
    auto& [group, waiting] = *item;
    const std::size_t before = overdue.sends.size();
    for (const WaitingSend& send : waiting) {
      if (send.give_up <= now) overdue.sends.push_back(send.id);
    }
    waiting.erase(std::remove_if(waiting.begin(), waiting.end(), [&](const auto& send) { return send.give_up <= now; }),
                  waiting.end());
    if (overdue.sends.size() > before && !waiting.empty()) overdue.groups_to_ask.push_back(group);
    item = waiting.empty() ? waiting_.erase(item) : std::next(item);
  }
  return overdue;
}

void GroupSends::replace(SendId former, SendId id, const HeldPacket& packet) {
  auto fan_out = fan_outs_.extract(former);
  fan_out.key() = id;
  fan_out.mapped().packet = packet;
  fan_outs_.insert(std::move(fan_out));
}

std::optional<GroupSends::Missed> GroupSends::part_finished(SendId id, const std::string& member, bool delivered,
                                                            const std::string& reason) {
  const auto found = fan_outs_.find(id);
  if (found == fan_outs_.end()) return std::nullopt;
  Missed& missed = found->second.missed;
  if (!delivered) {
    missed.text += (missed.members.empty() ? "" : ", ") + member + " (" + reason + ")";
    missed.members.push_back(member);
  }
  if (--found->second.open > 0) return std::nullopt;
  const Missed result = std::move(missed);
  fan_outs_.erase(found);
  return result;
}

}  // namespace adhoc_communication::multicast
