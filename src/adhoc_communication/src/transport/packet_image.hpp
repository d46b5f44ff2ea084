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
  std::uint32_t unpacked_size = 0;  ///< octets that the payload unpacks to; 0: it is not packed
};

using Image = std::shared_ptr<const Bytes>;

/// Octets of the packet before compression.
std::size_t image_size(const std::string& group, const std::string& topic, std::size_t payload);

/// Compresses the payload (zstd) where that makes it smaller, and notes its size. Leaves alone what is packed already.
void pack(Bytes& payload, std::uint32_t& unpacked_size);
/// False, and the payload as it was, if it does not unpack to that size.
bool unpack(Bytes& payload, std::uint32_t& unpacked_size);

/// The payload as it is.
Image image_of(const Packet& packet);
/// Nothing if the image is malformed or says that it unpacks to more than `largest` octets. The payload stays packed.
std::optional<Packet> parse(Bytes image, std::size_t largest);

/// As image_of(), packed.
Image encode(Packet packet);
/// As parse(), unpacked. Never writes more than `largest` octets.
std::optional<Packet> decode(Bytes image, std::size_t largest);

}  // namespace adhoc_communication::transport
