// The first 43 octets of every frame.
#pragma once

#include <optional>

#include "wire/octets.hpp"

namespace adhoc_communication::wire {

constexpr std::uint8_t kVersion = 2;
constexpr std::size_t kHeaderSize = 43;
constexpr std::size_t kTagSize = 16;      ///< room kept free behind the body for an authentication tag
constexpr std::size_t kChecksumSize = 4;  ///< what stands there in an open frame: CRC-32 of all before
constexpr std::size_t kEthernetHeaderSize = 14;
constexpr MacAddress kEverybody = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff};

enum class FrameType : std::uint8_t {
  kBeacon = 1,
  kRouteRequest = 2,
  kRouteReply = 3,
  kRouteError = 4,
  kHopAcknowledgment = 5,
  kData = 6,
  kTransportAcknowledgment = 7,
  kBroadcastData = 8,
  kFlood = 9,
  kGroupActivation = 10,
  kGroupRefusal = 11,
  kGroupData = 12,
  kGroupReport = 13,
  kRouteReplyAcknowledgment = 14,
  kGroupReceipts = 15,
};

enum HeaderFlags : std::uint8_t {
  kSealed = 0x01,               ///< the body is encrypted and a tag follows it
  kWantsAcknowledgment = 0x02,  ///< link_sequence is meaningful, the next hop acknowledges
  kAcknowledgeNow = 0x04,       ///< do not wait for more frames before acknowledging
};

struct FrameHeader {
  FrameType type = FrameType::kBeacon;
  std::uint8_t flags = 0;
  MacAddress sender{};
  BootId boot_id{};
  std::uint64_t counter = 0;        ///< grows with every transmission of the sender, also with a repetition
  MacAddress next_hop{};            ///< kEverybody for a broadcast
  std::uint32_t link_sequence = 0;  ///< per sender and next hop; the same in every repetition
};

void write(Writer& writer, const FrameHeader& header);

/// Nothing for another version, an unknown type or flag, or too few octets.
std::optional<FrameHeader> read_header(Reader& reader);

/// An open frame as it goes on the air.
Bytes close_openly(const FrameHeader& header, const Bytes& body);
/// The reader over the body of an open frame, if the checksum is right.
std::optional<Reader> open_body(const Bytes& frame);

}  // namespace adhoc_communication::wire
