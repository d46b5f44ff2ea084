#include "multicast/groups.hpp"

#include <algorithm>

#include "transport/hop_sender.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

std::optional<std::string> root_of(const std::string& group) {
  const std::string prefix = kPrefix;
  if (group.size() <= prefix.size() || group.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  return group.substr(prefix.size());
}

bool Groups::replace_waiting(const std::string& group, SendId former, SendId id, const transport::Image& image) {
  const auto sends = waiting.find(group);
  if (sends == waiting.end()) return false;
  for (WaitingSend& send : sends->second) {
    if (send.id != former) continue;
    send.id = id;
    send.image = image;
    return true;
  }
  return false;
}

void Groups::drop_waiting(const std::string& group, SendId id) {
  const auto sends = waiting.find(group);
  if (sends == waiting.end()) return;
  auto& all = sends->second;
  all.erase(std::remove_if(all.begin(), all.end(), [id](const WaitingSend& send) { return send.id == id; }), all.end());
  if (all.empty()) waiting.erase(sends);
}

void hold(std::deque<HeldPacket>& held, HeldPacket packet, Time now) {
  held.push_back(std::move(packet));
  std::size_t octets = 0;
  for (const HeldPacket& kept : held) octets += kept.image->size();
  while (!held.empty() && (now - held.front().sent >= Groups::kHeld || held.size() > Groups::kMostHeld ||
                           octets > Groups::kMostHeldOctets)) {
    octets -= held.front().image->size();
    held.pop_front();
  }
}

Bytes encode_copy(const HeldPacket& packet) {
  Bytes payload;
  wire::Writer writer(payload);
  writer.u8(packet.stream);
  writer.u32(packet.number);
  writer.octets(*packet.image);
  return payload;
}

std::optional<Copy> decode_copy(const Bytes& payload) {
  wire::Reader reader(payload);
  Copy copy{reader.u8(), reader.u32(), {}};
  copy.image = reader.rest();
  if (!reader.ok() || copy.stream >= transport::kPriorities || copy.image.empty()) return std::nullopt;
  return copy;
}

Bytes encode_members(const std::set<std::string>& members) {
  Bytes payload;
  wire::Writer writer(payload);
  writer.u16(static_cast<std::uint16_t>(members.size()));
  for (const std::string& member : members) writer.text8(member);
  return payload;
}

std::optional<std::vector<std::string>> decode_members(const Bytes& payload) {
  wire::Reader reader(payload);
  std::vector<std::string> members;
  for (std::size_t left = reader.u16(); left > 0 && reader.ok(); --left) {
    members.push_back(reader.text8());
    if (!wire::is_name(members.back())) return std::nullopt;
  }
  if (!reader.at_end()) return std::nullopt;
  return members;
}

}  // namespace adhoc_communication::multicast
