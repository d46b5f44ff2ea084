// Groups mc_<robot>: their names, and what packets of their own kinds say.
//
// The robot a group is named after is its root and the only one that knows its members. Its packets go along a tree; a
// member that is not the root asks the root for the members and sends one reliable unicast to each.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "transport/packet_image.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

constexpr char kPrefix[] = "mc_";

inline std::string group_of(const std::string& robot) { return kPrefix + robot; }
/// The robot that a group is named after; nothing if the name is not that of a group.
std::optional<std::string> root_of(const std::string& group);

/// A packet of the own group, kept for members that come late or come back.
struct HeldPacket {
  std::uint8_t stream = 0;
  std::uint32_t number = 0;
  transport::Image image;
  Time sent{0};
  Time until = Time::max();  ///< when it is of no use any more
};

/// The payload of a packet of kind kGroupCopy.
Bytes encode_copy(const HeldPacket& packet);
struct Copy {
  std::uint8_t stream;
  std::uint32_t number;
  Bytes image;
};
std::optional<Copy> decode_copy(const Bytes& payload);

Bytes encode_members(const std::set<std::string>& members);
/// Nothing if malformed.
std::optional<std::vector<std::string>> decode_members(const Bytes& payload);

}  // namespace adhoc_communication::multicast
