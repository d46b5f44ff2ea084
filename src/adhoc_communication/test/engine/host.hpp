// One engine under test, and hosts without engines around it that say what a test makes them say.
//
// What a host says reaches the node at once. What the node puts on the air is kept, to be read as messages.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "payloads.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication {

/// Frame type and reader of a message.
template <typename Message>
struct Kind;

#define ADHOC_KIND(message, frame_type, reader)                               \
  template <>                                                                 \
  struct Kind<wire::message> {                                                \
    static constexpr wire::FrameType kType = wire::FrameType::frame_type;     \
    static auto read(const wire::Reader& body) { return wire::reader(body); } \
  }
ADHOC_KIND(Beacon, kBeacon, read_beacon);
ADHOC_KIND(RouteRequest, kRouteRequest, read_route_request);
ADHOC_KIND(RouteReply, kRouteReply, read_route_reply);
ADHOC_KIND(RouteError, kRouteError, read_route_error);
ADHOC_KIND(HopAcknowledgment, kHopAcknowledgment, read_hop_acknowledgment);
ADHOC_KIND(Data, kData, read_data);
ADHOC_KIND(TransportAcknowledgment, kTransportAcknowledgment, read_transport_acknowledgment);
ADHOC_KIND(GroupActivation, kGroupActivation, read_group_activation);
ADHOC_KIND(GroupRefusal, kGroupRefusal, read_group_refusal);
ADHOC_KIND(GroupData, kGroupData, read_group_data);
ADHOC_KIND(GroupReport, kGroupReport, read_group_report);
ADHOC_KIND(GroupReceipts, kGroupReceipts, read_group_receipts);
#undef ADHOC_KIND

struct Host {
  std::string name;
  MacAddress address{};
  BootId boot_id{};
  std::uint32_t sequence = 1;               ///< own number
  bool beacons = true;                      ///< every kInterval, naming the node
  bool acknowledges = true;                 ///< frames to it, on the hop
  std::uint32_t announced_interval_ms = 0;  ///< in beacons
  std::uint16_t beacons_said = 0;
  std::uint64_t counter = 0;

  wire::BootTag boot() const { return wire::boot_tag(boot_id); }
};

/// host_<number>, wherever it is.
Host make_host(std::size_t number);

/// Hosts that the node does not hear itself.
inline const Host kFar = make_host(100);
inline const Host kFarther = make_host(101);
inline const Host kSource = make_host(101);

template <typename Message>
struct Sent {
  Time at;
  MacAddress to;
  Message message;
};

class Stage {
 public:
  static constexpr Time kInterval = std::chrono::milliseconds(200);

  explicit Stage(EngineOptions options = {});

  Engine& node() { return team.engine(0); }
  /// The node as others see it.
  Host self() const;
  Time now() const { return team.now(); }

  /// host_<number> in reach of the node; `known`: it has said so and is heard.
  Host& neighbor(std::size_t number, bool known = true);
  void beacon(Host& host);
  /// The host starts again, and goes on until the node has asked its former run in vain.
  void restart(Host& host);
  /// Tells the node that the host hears it, and nothing else.
  void acknowledge(Host& host);
  /// A route of so many hops by way of a neighbour, told by a reply that nobody else is meant to have.
  void give_route(Host& via, const Host& destination, int hops = 2, Time lifetime = std::chrono::seconds(10));

  template <typename Message>
  void say(Host& host, const Message& message, const MacAddress& to = wire::kEverybody) {
    say_octets(host, Kind<Message>::kType, wire::to_bytes(message), to);
  }
  void say_octets(Host& host, wire::FrameType type, const Bytes& body, const MacAddress& to = wire::kEverybody);

  void run_for(Time duration);

  /// What the node has sent of this kind since forget(), in order.
  template <typename Message>
  std::vector<Sent<Message>> sent() const;
  /// Of the requests only the broadcasts: neighbours that seem to have missed one get a copy each besides.
  std::vector<Sent<wire::RouteRequest>> requests() const;
  const std::vector<std::pair<Time, Frame>>& frames() const { return frames_; }
  std::size_t count(wire::FrameType type) const;
  void forget() { frames_.clear(); }

  std::optional<RouteState> entry(const Host& destination);
  /// As entry(), if packets may take it now.
  std::optional<RouteState> route(const Host& destination);
  std::uint64_t malformed() { return node().statistics().frames_dropped.malformed; }

  Team team;

 private:
  void answer(const Frame& frame);

  std::map<std::size_t, Host> hosts_;
  std::vector<std::pair<Time, Frame>> frames_;
  Time beacons_due_ = kInterval;
};

/// Robots that do not join groups by themselves, so that all that is heard was asked for.
EngineOptions without_groups(EngineOptions options = {});

wire::RouteRequest request_for(const Host& destination, const Host& originator, std::uint32_t id = 1);
wire::RouteReply reply_about(const Host& destination, const Host& originator);
/// All packets before `next` of a stream from `to` have come.
wire::TransportAcknowledgment acknowledgment_of(const Host& from, const Host& to, std::uint32_t next);
wire::RouteError error_about(const std::vector<std::pair<Host, std::uint32_t>>& lost);
/// A packet of one segment.
wire::Data data_for(const Host& destination, const Host& source, std::uint32_t packet = 1);

template <typename Message>
std::vector<Sent<Message>> Stage::sent() const {
  std::vector<Sent<Message>> result;
  for (const auto& [at, frame] : frames_) {
    if (frame.bytes[1] != static_cast<std::uint8_t>(Kind<Message>::kType)) continue;
    auto message = Kind<Message>::read(wire::open_body(frame.bytes).value());
    result.push_back({at, frame.destination, std::move(message.value())});
  }
  return result;
}

}  // namespace adhoc_communication
