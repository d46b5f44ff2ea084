// A packet as one octet string: what is cut into segments, and the compression of the payload.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

enum class PacketKind : std::uint8_t {
  kUser = 0,
  kGroupJoin = 1,
  kGroupLeave = 2,
  kGroupMembersRequest = 3,
  kGroupMembers = 4,
  kGroupCopy = 5,  ///< a packet for the group, sent to this member by itself
};

struct Packet {
  PacketKind kind = PacketKind::kUser;
  std::uint8_t payload_type = 0;
  std::string group;
  std::string topic;
  Bytes payload;
  bool latched = false;
};

using Image = std::shared_ptr<const Bytes>;

/// Octets of the packet before compression.
std::size_t image_size(const std::string& group, const std::string& topic, std::size_t payload);

/// The payload is compressed (zstd) where that makes it smaller.
Image encode(const Packet& packet);

/// Nothing if the image is malformed or unpacks to more than `largest` octets; never writes more than that.
std::optional<Packet> decode(const Bytes& image, std::size_t largest);

}  // namespace adhoc_communication::transport
