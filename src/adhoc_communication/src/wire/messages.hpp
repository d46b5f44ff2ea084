// The body of each frame type as a plain value. read() is strict: nothing for a body that is too short, too long or
// holds a value outside its range.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "wire/octets.hpp"

namespace adhoc_communication::wire {

constexpr std::size_t kLongestName = 64;   ///< octets of a robot name
constexpr std::uint8_t kFarthestHop = 35;  ///< RFC 3561 section 10, NET_DIAMETER

/// Names go to logs, files and terminals, so no octet of theirs does anything there.
inline bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), [](char character) { return character > ' ' && character <= '~'; });
}

/// The first 6 octets of the boot id of a neighbour: who it is, and that it lives now.
using NeighborTag = std::uint64_t;
constexpr NeighborTag neighbor_tag(BootTag boot) { return boot >> 16; }

/// A neighbour the sender of a beacon hears, so that the neighbour knows the link works both ways.
struct HeardNeighbor {
  NeighborTag tag = 0;
  std::uint8_t loss = 0;  ///< of that neighbour's beacons, in 255ths
};

/// What the sender of a beacon knows of a robot that not all of its neighbours hear themselves.
struct Rumor {
  MacAddress address{};
  BootTag boot = 0;
  std::uint32_t alive = 0;  ///< life sign of that robot; only a greater one is news
  std::uint8_t hops = 0;    ///< from the sender of the beacon
  std::string name;
};

/// RFC 3561 section 6.9 hello, with what discovery needs.
struct Beacon {
  std::uint32_t sequence_number = 0;  ///< own AODV sequence number
  std::uint32_t alive = 0;
  std::uint16_t number = 0;  ///< of the sender's broadcast beacons; shows which were missed
  std::string name;
  std::uint16_t heard_count = 0;     ///< of neighbours that beacons name in turn; 0: says nothing about it
  std::vector<HeardNeighbor> heard;  ///< those whose turn it is
  std::vector<Rumor> rumors;
  std::uint32_t interval_ms = 0;  ///< until the next beacon (section 9.1); 0 not said
};

/// RFC 3561 section 5.1. The destination is known by name, by address, or both.
struct RouteRequest {
  bool join = false;
  bool repair = false;
  bool gratuitous = false;
  bool destination_only = false;
  bool unknown_sequence_number = false;
  std::uint8_t hop_count = 0;
  std::uint8_t hop_limit = 0;
  std::uint16_t cost = 0;  ///< of the way from here back to the originator
  std::uint32_t id = 0;
  MacAddress destination{};  ///< all zero: asked for by name only
  std::uint32_t destination_sequence = 0;
  std::string destination_name;
  MacAddress originator{};
  std::uint32_t originator_sequence = 0;
  BootTag originator_boot = 0;
  std::string originator_name;
  bool directed = false;  ///< not flooded: from robot to robot, each of which has news of the destination from the next
};

/// RFC 3561 section 5.2.
struct RouteReply {
  bool repair = false;
  bool acknowledgment_required = false;
  std::uint8_t hop_count = 0;
  std::uint16_t cost = 0;  ///< of the way from the sender to the destination
  MacAddress destination{};
  std::uint32_t destination_sequence = 0;
  BootTag destination_boot = 0;
  std::string destination_name;
  MacAddress originator{};
  std::uint32_t lifetime_ms = 0;
};

struct UnreachableDestination {
  MacAddress address{};
  std::uint32_t sequence = 0;
};

/// RFC 3561 section 5.3.
struct RouteError {
  bool no_delete = false;
  bool unknown_sequence = false;  ///< the sender knows no numbers; each receiver raises its own by one
  std::vector<UnreachableDestination> destinations;  ///< at least one, at most 255
};

/// What one robot has received of another's frames on one hop.
struct HopAcknowledgment {
  BootTag boot = 0;                  ///< of the run of the robot whose frames these are
  std::uint64_t newest_counter = 0;  ///< counter of the transmission received last
  std::uint32_t spacing_ns = 0;      ///< between the arrivals of that one and the one sent just before; 0 unknown
  std::uint32_t held_ns = 0;         ///< between the arrival of that one and this acknowledgment
  std::uint32_t highest = 0;         ///< highest link sequence received
  std::uint64_t received = 0;        ///< bit i: link sequence highest - i was received
};

/// One segment of a packet on its way over any number of hops.
struct Data {
  MacAddress source{};
  BootTag source_boot = 0;
  MacAddress destination{};
  std::uint8_t stream = 0;  ///< priority; order is kept within a stream
  bool acknowledge_now = false;
  std::uint8_t hops = 1;           ///< counting the one it travels now
  std::uint32_t packet = 0;        ///< number of the packet in its stream
  std::uint32_t base = 0;          ///< the receiver need not wait for packets before this one
  std::uint32_t index = 0;         ///< of the segment
  std::uint32_t total = 0;         ///< octets of the whole packet image
  std::uint16_t segment_size = 0;  ///< octets of every segment but the last
  std::uint8_t attempt = 0;        ///< raised when the packet is begun anew
  Bytes octets;
};
constexpr std::size_t kDataHeaderSize = 41;
constexpr std::uint16_t kLongestSegment = 2304;  ///< no link carries longer frames
constexpr std::uint16_t kShortestSegment = 64;   ///< of a packet that takes several

/// Which segments of one unfinished packet have arrived.
struct PartialPacket {
  std::uint32_t packet = 0;
  std::uint8_t attempt = 0;  ///< that of its newest segment
  std::uint32_t first_missing = 0;
  Bytes received;  ///< bit i (least significant first): segment first_missing + 1 + i
};

/// A packet for which the receiver has no room; of what has arrived of it nothing is left.
struct RefusedPacket {
  std::uint32_t packet = 0;
  std::uint8_t attempt = 0;  ///< a later one may be taken
};

/// State of one stream at its receiver.
struct TransportAcknowledgment {
  MacAddress source{};  ///< the acknowledging robot
  BootTag source_boot = 0;
  MacAddress destination{};  ///< the robot whose packets these are
  BootTag destination_boot = 0;
  std::uint8_t stream = 0;
  std::uint8_t hops = 1;
  std::uint32_t next = 0;  ///< every packet before this one has been delivered or given up
  std::vector<PartialPacket> partial;
  std::vector<RefusedPacket> refused;
};

/// One segment of a packet for everybody in range.
struct BroadcastData {
  std::uint32_t packet = 0;
  std::uint32_t index = 0;
  std::uint32_t total = 0;
  std::uint16_t segment_size = 0;
  Bytes octets;
};
constexpr std::size_t kBroadcastDataHeaderSize = 14;

/// A packet in one frame for everybody within some hops.
struct Flood {
  MacAddress source{};
  BootTag source_boot = 0;
  std::uint32_t id = 0;
  std::uint8_t hop_count = 0;
  std::uint8_t hop_limit = 1;
  std::string source_name;
  Bytes image;
};

/// The tree of a group grows by this message from the root towards the members (MACT of MAODV).
struct GroupActivation {
  MacAddress root{};
  BootTag root_boot = 0;
  std::uint32_t epoch = 0;          ///< raised by the root whenever it builds the tree anew
  std::vector<MacAddress> members;  ///< to be reached through the receiver, itself perhaps among them; none: pruned
};
constexpr std::size_t kMostMembersOfActivation = 200;
constexpr std::size_t kActivationHeaderSize = 19;

/// Members that the sender cannot reach, told to its upstream neighbour.
struct GroupRefusal {
  MacAddress root{};
  BootTag root_boot = 0;
  std::uint32_t epoch = 0;
  std::vector<MacAddress> members;
};

/// One symbol of one block of a group packet; without octets a question for the state of the packet.
struct GroupData {
  MacAddress root{};
  BootTag root_boot = 0;
  std::uint8_t stream = 0;         ///< priority; order is kept within a stream
  bool report = false;             ///< the receiver answers with a report
  bool follows = false;            ///< handed to the radio together with the frame before: measures the air
  bool flooded = false;            ///< a whole packet, which everybody who hears it passes on once
  std::uint8_t hops = 1;           ///< counting the one it travels now
  std::uint16_t round = 0;         ///< of the sender of this frame; reports repeat it
  std::uint32_t packet = 0;        ///< number of the packet in its stream
  std::uint32_t base = 0;          ///< packets before this one are finished at the root
  std::uint32_t total = 0;         ///< octets of the whole packet image
  std::uint16_t segment_size = 0;  ///< octets of a symbol; the last frame of the packet may be shorter
  std::uint16_t block = 0;
  std::uint8_t symbol = 0;  ///< frames of the block first, then parity
  Bytes octets;
};
constexpr std::size_t kGroupDataHeaderSize = 37;

/// What a robot and those behind it have of a group packet, told to the upstream neighbour.
struct GroupReport {
  MacAddress root{};
  BootTag root_boot = 0;
  std::uint8_t stream = 0;
  std::uint32_t packet = 0;
  std::uint32_t epoch = 0;
  std::uint16_t round = 0;             ///< greatest one heard
  bool complete = false;               ///< the robot and all behind it have the packet
  std::uint64_t measured_counter = 0;  ///< of a frame from upstream that followed directly; 0 none
  std::uint32_t spacing_ns = 0;        ///< between its arrival and that of the frame before
  std::uint32_t coverage = 0;          ///< which members that is: exclusive or of their digests
  std::uint16_t first_block = 0;       ///< all blocks before are complete
  Bytes missing;  ///< symbols missing of the blocks from there on, of blocks up to 3 frames as bits
};
constexpr std::size_t kMostBlocksOfReport = 16;
/// As first_block: there is no room for the packet, and nothing of it is here. No packet has so many blocks.
constexpr std::uint16_t kNoRoom = 0xffff;

/// What a member has of the packets of a root.
struct GroupReceipt {
  MacAddress root{};
  BootTag root_boot = 0;
  std::uint8_t stream = 0;
  MacAddress member{};
  std::uint32_t next = 0;    ///< packets before this one have been delivered, or will not come any more
  std::uint32_t beyond = 0;  ///< bit i: packet next + 1 + i is there
  bool by_route = false;     ///< rather than back where the packets came from, where somebody's way has ended
};
constexpr std::size_t kGroupReceiptSize = 29;

/// About flooded packets, on the way to their roots.
struct GroupReceipts {
  std::vector<GroupReceipt> receipts;
};
constexpr std::size_t kMostReceipts = 48;

void write(Writer& writer, const Beacon& beacon);
void write(Writer& writer, const RouteRequest& request);
void write(Writer& writer, const RouteReply& reply);
void write(Writer& writer, const RouteError& error);
void write(Writer& writer, const HopAcknowledgment& acknowledgment);
void write(Writer& writer, const Data& data);
void write(Writer& writer, const TransportAcknowledgment& acknowledgment);
void write(Writer& writer, const BroadcastData& data);
void write(Writer& writer, const Flood& flood);
void write(Writer& writer, const GroupActivation& activation);
void write(Writer& writer, const GroupRefusal& refusal);
void write(Writer& writer, const GroupData& data);
void write(Writer& writer, const GroupReport& report);
void write(Writer& writer, const GroupReceipts& receipts);

template <typename Message>
Bytes to_bytes(const Message& message) {
  Bytes bytes;
  Writer writer(bytes);
  write(writer, message);
  return bytes;
}

std::optional<Beacon> read_beacon(Reader reader);
std::optional<RouteRequest> read_route_request(Reader reader);
std::optional<RouteReply> read_route_reply(Reader reader);
std::optional<RouteError> read_route_error(Reader reader);
std::optional<HopAcknowledgment> read_hop_acknowledgment(Reader reader);
std::optional<Data> read_data(Reader reader);
std::optional<TransportAcknowledgment> read_transport_acknowledgment(Reader reader);
std::optional<BroadcastData> read_broadcast_data(Reader reader);
std::optional<Flood> read_flood(Reader reader);
std::optional<GroupActivation> read_group_activation(Reader reader);
std::optional<GroupRefusal> read_group_refusal(Reader reader);
std::optional<GroupData> read_group_data(Reader reader);
std::optional<GroupReport> read_group_report(Reader reader);
std::optional<GroupReceipts> read_group_receipts(Reader reader);

}  // namespace adhoc_communication::wire
