#include "multicast/groups.hpp"

#include "transport/hop_sender.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

std::optional<std::string> root_of(const std::string& group) {
  const std::string prefix = kPrefix;
  if (group.size() <= prefix.size() || group.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  return group.substr(prefix.size());
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
