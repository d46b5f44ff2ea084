// A packet that is not finished yet, and why it was sent.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "transport/packet_image.hpp"

namespace adhoc_communication::transport {

enum class Purpose {
  kHost,
  kFanOut,          ///< carries a send of the host to one member of a group
  kCatchUp,         ///< carries an earlier packet of the own group to a newcomer
  kWord,            ///< tells the root of a group something; its end matters to the membership
  kMembersRequest,  ///< asks the root of a group for its members
  kInternal,        ///< its end matters to nobody
};

struct Sending {
  Purpose purpose = Purpose::kHost;
  std::string destination;
  std::string group{};  ///< of which its root is told or asked something
  SendId parent = 0;    ///< of kFanOut: the send of the host
  std::size_t octets = 0;
  std::optional<std::pair<std::uint8_t, std::uint32_t>> copy{};  ///< stream and number, of a copy of a group packet
  Priority priority = Priority::kNormal;
  Time lifetime{0};                     ///< 0: none
  PacketKind word = PacketKind::kUser;  ///< of kWord
};

}  // namespace adhoc_communication::transport
