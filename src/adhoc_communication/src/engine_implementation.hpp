// The layers of the engine put together. Each file engine_*.cpp holds one part of this class.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/engine.hpp"
#include "air/transmitter.hpp"
#include "api/event_queue.hpp"
#include "api/journal.hpp"
#include "busy_map.hpp"
#include "identity.hpp"
#include "multicast/distributor.hpp"
#include "multicast/group_sends.hpp"
#include "multicast/memberships.hpp"
#include "multicast/own_group.hpp"
#include "presence/beacon_rhythm.hpp"
#include "random.hpp"
#include "routing/router.hpp"
#include "security/frame_guard.hpp"
#include "transport/air_clock.hpp"
#include "transport/broadcast.hpp"
#include "transport/fair_share.hpp"
#include "transport/flood.hpp"
#include "transport/forwarder.hpp"
#include "transport/hops.hpp"
#include "transport/packet_image.hpp"
#include "transport/send_terms.hpp"
#include "transport/stream_receivers.hpp"
#include "transport/streams.hpp"

namespace adhoc_communication {

class Engine::Implementation {
 public:
  static constexpr std::size_t kMostSends = 256;              ///< packets of the host not finished yet
  static constexpr std::size_t kMostSendOctets = 64'000'000;  ///< of these packets, as they go on the air
  static constexpr std::size_t kMostFloodOctets = 64'000;     ///< of one, unpacked; of a robot's words on groups, too

  Implementation(EngineOptions options, MacAddress address, BootId boot_id, std::uint64_t seed, Time now);

  // The interface of the engine.
  void receive(const Frame& frame, Time now);
  SendId send(SendRequest request, Time now);
  SendId broadcast(BroadcastRequest request, Time now);
  std::vector<Frame> poll(Time now);
  Time next_deadline() const;
  std::optional<Event> next_event() { return events_.next(); }
  std::vector<Record> take_records();
  void join_group(const std::string& group, Time now);
  void leave_group(const std::string& group, Time now);
  GroupState group_state(const std::string& group) const;
  std::vector<std::string> neighbors() const;
  std::vector<std::string> robots() const { return directory_.names(); }
  const Statistics& statistics() const { return statistics_; }
  const std::string& robot_name() const { return self_.name; }
  const routing::Router& router() const { return router_; }
  void set_keys(std::vector<TeamKey> keys);
  std::vector<TableFill> tables() const;

  // engine_restart.cpp: another run of the same host.
  EngineOptions options() const;
  void succeed(Implementation& former, Time now);

  // engine_introspection.cpp: what a host may look at.
  std::vector<TreeState> trees() const;
  std::vector<LinkState> links() const;
  QueueState queues() const;
  std::vector<std::string> groups() const;
  std::optional<std::string> name_of(const MacAddress& robot) const;
  std::string name_or_address(const MacAddress& robot) const;

 private:
  enum class Purpose { kHost, kFanOut, kCatchUp, kWord, kMembersRequest, kInternal };
  /// A packet not finished yet.
  struct Sending {
    Purpose purpose = Purpose::kHost;
    std::string destination;
    std::string group;  ///< of which its root is told or asked something
    SendId parent = 0;  ///< of kFanOut: the group send
    std::size_t octets = 0;
    std::optional<std::pair<std::uint8_t, std::uint32_t>> copy{};  ///< stream and number, of a copy of a group packet
    Priority priority = Priority::kNormal;
    Time lifetime{0};              ///< 0: none
    multicast::Word::Kind word{};  ///< of kWord
  };

  void touch(Time now) {
    now_ = now;
    touched_ = true;
  }

  // engine_frames.cpp: frames in and out.
  void settle();
  void dispatch(const wire::FrameHeader& header, wire::Reader body, Time now);
  bool hear(const wire::FrameHeader& header, Time now);
  bool lost_artificially(wire::FrameType type);
  void malformed() { ++statistics_.frames_dropped.malformed; }
  bool proves_itself(const security::OpenedFrame& opened, Time now);
  bool lives(const security::OpenedFrame& opened, Time now);

  // engine_beacons.cpp: presence.
  void send_beacon(Time now);
  wire::Beacon plain_beacon(Time now) const;
  void probe(const MacAddress& neighbor, Time now);
  void on_beacon(const MacAddress& from, wire::BootTag boot, const wire::Beacon& beacon, Time now);
  void maintain(Time now);
  void announce_changes(Time now);

  // engine_records.cpp: what hosts may write down.

  // engine_restart.cpp
  void end(const std::string& reason, Time now);

  // engine_transport.cpp: packets.
  void link_lost(const MacAddress& neighbor, Time now);
  void on_data(const MacAddress& from, wire::Data data, Time now);
  void deliver_data(const wire::Data& data, Time now);
  void on_transport_acknowledgment(const MacAddress& from, wire::TransportAcknowledgment acknowledgment, Time now);
  void on_broadcast_data(const wire::FrameHeader& header, const wire::BroadcastData& data, Time now);
  void on_flood(const wire::Flood& flood, Time now);
  void serve_floods(Time now);
  void forget_evicted(Time now);
  enum class Carrier { kStream, kBroadcast, kGroup };
  bool admits(Carrier carrier, const std::string& source, const transport::Packet& packet) const;
  void deliver_packet(Carrier carrier, const std::string& source, const Bytes& image, std::uint8_t hops, Time now);
  void serve_streams(Time now);
  void fail_unreachable(Time now);
  void pump(Time now);
  bool pump_priority(std::uint8_t priority, Time now);
  std::vector<MacAddress> waiting_hops(std::uint8_t priority) const;
  bool pump_hop(const MacAddress& previous_hop, std::uint8_t priority, Time now);
  bool pump_frames(const MacAddress& previous_hop, std::uint8_t priority, Time now);
  bool pump_broadcasts(std::uint8_t priority, Time now);
  bool pump_groups(const MacAddress& previous_hop, std::uint8_t priority, Time now);
  bool something_to_send() const;

  // engine_sends.cpp: requests of the host and their ends.
  std::string refusal(const SendRequest& request) const;
  SendId refuse(std::string reason);
  void start(SendId id, const std::string& destination, const transport::Image& image, Priority priority, Time now);
  SendId start_unicast(const std::string& destination, transport::Image image, Priority priority, Sending sending,
                       Time now);
  void start_group_send(SendId id, const std::string& group, transport::Image image, Priority priority, Time now);
  void send_to_own_group(SendId id, const transport::Image& image, Priority priority, Time now);
  void fan_out(SendId id, const std::vector<std::string>& members, const transport::Image& image, Priority priority,
               Time now);
  void finish(SendId id, bool delivered, const std::string& reason, Time now, bool superseded = false);
  void finish_fan_out_part(SendId parent, const std::string& member, bool delivered, const std::string& reason,
                           Time now);
  void report(Event event) { events_.add(std::move(event)); }

  // engine_terms.cpp: sends that end before they are delivered.
  bool takes_place(SendId id, const transport::SendTerms::Subject& subject, const transport::Image& image, Time now);
  bool replace(SendId former, SendId id, const transport::Image& image, Time now);
  bool replace_in_own_group(SendId former, SendId id, const transport::Image& image, Time now);
  void expire_sends(Time now);
  void cancel(SendId id, Time now);
  std::string cancel_group_send(SendId id, Time now);

  // engine_groups.cpp: membership.
  bool takes_part(const MacAddress& root) const;
  void carry_out_memberships(Time now);
  const multicast::Tree* tree_of(const MacAddress& root) const;
  std::set<MacAddress> ways_to_members() const;
  void send_members(const std::string& robot, Time now);
  void on_group_packet(const std::string& source, const transport::Packet& packet, Time now);
  void on_members(const std::string& group, const std::vector<std::string>& members, Time now);
  void request_members(const std::string& group, Time now);
  void fail_waiting_sends(const std::string& group, const std::string& reason, Time now);
  void expire_waiting_sends(Time now);
  void admit_member(const std::string& member, Time now);
  void leave_out(const std::string& member, const std::string& reason, Time now);
  void send_copy(const std::string& member, const multicast::HeldPacket& packet, Purpose purpose, SendId parent,
                 Time now);
  void copy_finished(const Sending& copy);
  void on_copy(const std::string& source, const transport::Packet& packet, Time now);
  void finish_group_members(Time now);
  void take_group_packets(Time now);
  void send_control(Sending sending, transport::PacketKind kind, Bytes payload, Time now);

  EngineOptions options_;
  Identity self_;
  Statistics statistics_;
  Journal journal_;
  security::FrameGuard guard_;
  Random random_;
  presence::BeaconRhythm rhythm_;
  routing::Neighbors neighbors_;
  routing::LivingRuns runs_;
  routing::RobotDirectory directory_;
  transport::AirClock air_;
  air::Transmitter transmitter_;
  transport::Hops hops_;
  routing::Router router_;
  std::size_t segment_size_;
  std::size_t broadcast_segment_size_;
  multicast::Carriage carriage_;
  transport::Reassembly reassembly_;
  transport::Streams streams_;
  transport::StreamReceivers receivers_;
  transport::Forwarder forwarder_;
  std::array<transport::BroadcastSender, transport::kPriorities> broadcasts_;
  transport::BroadcastReceiver broadcast_receiver_;
  transport::FloodRelay flood_;
  multicast::Distributor distributor_;
  multicast::OwnGroup own_group_;
  multicast::Memberships memberships_;
  multicast::GroupSends group_sends_;

  std::map<SendId, Sending> sendings_;
  transport::SendTerms terms_;
  std::size_t host_sends_ = 0;
  std::size_t octets_waiting_ = 0;
  SendId next_send_id_ = 1;
  std::uint32_t next_flood_id_ = 0;
  std::uint64_t last_group_counter_ = 0;
  MacAddress last_group_destination_ = wire::kEverybody;
  int group_pair_ = 0;  ///< counts frames of groups to that destination; 0 and 1 are a pair
  Time now_{0};
  std::uint16_t beacons_sent_ = 0;
  Time started_{0};
  Time expected_poll_ = Time::max();
  bool touched_ = true;  ///< something came in since the last poll
  /// Between the robots that frames come from, this one (all zero) among them; for each, between group and other
  /// frames.
  std::array<transport::FairShare<MacAddress>, transport::kPriorities> shares_;
  std::array<transport::FairShare<std::pair<MacAddress, bool>>, transport::kPriorities> group_shares_;
  EventQueue events_;
};

}  // namespace adhoc_communication
