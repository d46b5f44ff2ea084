// Values shared by the engine and its hosts.
#pragma once

#include <arpa/inet.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace adhoc_communication {

/// Time since any epoch the host likes, as long as it never goes back.
using Time = std::chrono::nanoseconds;
using Bytes = std::vector<std::uint8_t>;
/// A 48-bit hardware address. Ordered as its octets are; tables keyed by it are looked up for every frame, so it is
/// compared as one number.
struct MacAddress : std::array<std::uint8_t, 6> {
  std::uint64_t number() const {
    std::uint32_t high;
    std::uint16_t low;
    std::memcpy(&high, data(), sizeof high);
    std::memcpy(&low, data() + sizeof high, sizeof low);
    return std::uint64_t{ntohl(high)} << 16 | ntohs(low);
  }
  friend bool operator==(const MacAddress& a, const MacAddress& b) { return a.number() == b.number(); }
  friend bool operator!=(const MacAddress& a, const MacAddress& b) { return a.number() != b.number(); }
  friend bool operator<(const MacAddress& a, const MacAddress& b) { return a.number() < b.number(); }
  friend bool operator>(const MacAddress& a, const MacAddress& b) { return b < a; }
};
/// Drawn by the host at each start (getrandom on a robot), so that a restarted robot is told from its former self.
using BootId = std::array<std::uint8_t, 16>;
/// Secret shared by all robots of a team.
using TeamKey = std::array<std::uint8_t, 32>;

/// What a link carries: everything behind the Ethernet header, and the two addresses of that header.
/// The queue of the radio that a frame is for (IEEE 802.11e), where the link has several.
enum class AccessCategory : std::uint8_t { kBestEffort, kVideo, kVoice };

struct Frame {
  MacAddress destination{};
  MacAddress source{};
  Bytes bytes;
  AccessCategory category = AccessCategory::kBestEffort;
};

enum class Priority : std::uint8_t { kControl = 0, kPosition = 1, kNormal = 2, kBulk = 3 };

using SendId = std::uint64_t;

/// A packet to send. `destination` is a robot name, mc_<robot> for that robot's group, or empty for a one-hop
/// broadcast.
struct SendRequest {
  std::string destination;
  std::string topic;
  std::uint8_t payload_type = 0;  ///< contract: 'A' string, 'M' map, ...; 'X' any message type
  Bytes payload;
  Priority priority = Priority::kNormal;
  bool latched = true;       ///< who subscribes late at the receiver is given the packet, too
  Time lifetime{0};          ///< the send fails when it has not succeeded by then; 0: none
  bool newest_only = false;  ///< takes the place of such a packet of the same destination and topic not begun yet
  std::uint32_t unpacked_size = 0;  ///< octets that the payload unpacks to; 0: it is not packed, see compression.hpp
};

/// A packet flooded over at most `hop_limit` hops (0 means 1), one frame, unacknowledged.
struct BroadcastRequest {
  std::string topic;
  std::uint8_t payload_type = 0;
  Bytes payload;
  std::uint8_t hop_limit = 1;
  bool latched = true;
  std::uint32_t unpacked_size = 0;  ///< as in SendRequest
  Time lifetime{0};                 ///< it does not wait longer for the air; 0: as long as it takes
};

struct PacketReceived {
  std::string source;
  std::string group;  ///< empty unless sent to a group
  std::string topic;
  std::uint8_t payload_type = 0;
  Bytes payload;
  std::uint8_t hops = 1;
  bool latched = true;
  std::uint32_t unpacked_size = 0;  ///< as in SendRequest; unpack() gives the payload
};

/// End of a send; exactly one per accepted SendRequest. `reason` is a sentence for people, empty when delivered.
struct SendFinished {
  SendId id = 0;
  bool delivered = false;
  std::string reason;
  bool superseded = false;            ///< a newer packet has taken its place
  std::vector<std::string> missed{};  ///< of a send to a group: the members that are known not to have got it
};

struct RobotAppeared {
  std::string robot;
};

struct RobotLost {
  std::string robot;
};

/// Two robots have had this name for some time, perhaps this one is one of them.
struct NameTaken {
  std::string robot;
};

/// End of a group membership change asked for by the host.
struct GroupChangeFinished {
  std::string group;
  bool joined = false;
  bool succeeded = false;
  std::string reason;
};

using Event = std::variant<PacketReceived, SendFinished, RobotAppeared, RobotLost, NameTaken, GroupChangeFinished>;

/// Mirrors GetGroupState.srv.
struct GroupState {
  bool known = false;
  bool member = false;
  bool activated = false;
  bool connected = false;
  bool root = false;
  bool joining = false;
  std::string uplink;                  ///< next robot on the way to the root, or its address; empty without one
  std::string route_uplink;            ///< the same in the words of the original
  std::vector<std::string> downlinks;  ///< neighbours through which members are reached, or their addresses
  std::vector<std::string> members;    ///< at the root only
};

/// One entry of the routing table (RFC 3561 section 2).
struct RouteState {
  MacAddress destination{};
  MacAddress next_hop{};
  std::uint8_t hops = 0;
  double cost = 0.0;  ///< transmissions that a frame is expected to need on the whole way
  std::uint32_t sequence = 0;
  bool sequence_valid = false;
  bool valid = false;
  bool repairable = false;  ///< not valid because its next hop was lost here
  Time expires{0};
  std::vector<MacAddress> precursors;
  std::uint64_t boot = 0;  ///< first eight octets of the destination's boot id, of the run that the number belongs to
};

/// A robot's place in the tree of one root.
struct TreeState {
  MacAddress root{};
  std::uint64_t boot = 0;  ///< first eight octets of the root's boot id
  std::uint32_t epoch = 0;
  std::optional<MacAddress> upstream;
  std::vector<MacAddress> downstream;
  std::uint64_t upstream_boot = 0;  ///< first eight octets of its boot id
};

/// How full a table or queue of the engine is.
struct TableFill {
  const char* table;
  std::size_t size = 0;
  std::size_t most = 0;
};

/// Frames that were not believed, by reason.
struct FramesDropped {
  std::uint64_t malformed = 0;  ///< too short, altered, of another version, of unknown type
  std::uint64_t unsealed = 0;   ///< open, although this robot has a team key
  std::uint64_t no_key = 0;     ///< sealed, although this robot has no team key
  std::uint64_t forged = 0;     ///< no key of the team opens it
  std::uint64_t replayed = 0;   ///< heard before
  std::uint64_t reflected = 0;  ///< own frames thrown back
  std::uint64_t unproven = 0;   ///< of a run that has not shown yet that it is alive now
};

/// The hop to one neighbour, as it stands now.
struct LinkState {
  MacAddress address{};
  std::string name;            ///< empty until the neighbour has said it
  bool two_way = false;        ///< frames pass in both directions, so the link carries routes
  double loss = 0.0;           ///< of frames to the neighbour, 0..1
  std::size_t waiting = 0;     ///< frames that are to go to it
  std::size_t in_flight = 0;   ///< transmissions whose fate is open
  std::uint64_t given_up = 0;  ///< frames left to the end-to-end repetition
  Time silent_for{0};          ///< since the last frame from it
};

/// What waits inside the engine.
struct QueueState {
  std::size_t packets = 0;        ///< of the host, not finished yet
  std::size_t group_packets = 0;  ///< those of them that go to a group
  std::size_t octets = 0;         ///< of all these packets
  std::size_t events = 0;         ///< not fetched by the host yet
  // Octets of packets that are being put together.
  std::size_t stream_octets = 0;          ///< sent to this robot
  std::size_t group_octets = 0;           ///< on the trees of groups
  std::size_t complete_group_octets = 0;  ///< complete here, but not yet behind this robot
};

/// Frames that carry packets.
struct DataFrames {
  std::uint64_t sent = 0;             ///< own ones, for the first time
  std::uint64_t passed_on = 0;        ///< of others, for the first time
  std::uint64_t sent_again = 0;       ///< own ones repeated, on the first hop or from end to end
  std::uint64_t passed_on_again = 0;  ///< of others, repeated on this hop
  std::uint64_t received = 0;         ///< for the first time
};

struct Statistics {
  /// By frame type, see docs/protocol.md; index 0 is not used.
  static constexpr std::size_t kFrameTypes = 16;
  using ByType = std::array<std::uint64_t, kFrameTypes>;

  ByType frames_sent_by_type{};
  ByType frames_received_by_type{};  ///< without those dropped
  ByType bytes_sent_by_type{};       ///< with Ethernet headers, as all octets here
  ByType bytes_received_by_type{};
  DataFrames unicast_data;
  DataFrames group_data;
  std::uint64_t frames_received_again = 0;  ///< that a hop has repeated although they had arrived
  std::uint64_t records_lost = 0;           ///< that the host did not take in time
  std::uint64_t frames_sent = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t bytes_received = 0;
  FramesDropped frames_dropped;
  std::uint64_t packets_sent = 0;
  std::uint64_t packets_failed = 0;
  std::vector<std::uint64_t> packets_received_by_hops;  ///< index 0: one hop
};

}  // namespace adhoc_communication
