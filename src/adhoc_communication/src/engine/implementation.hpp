// The layers of the engine put together. What one of them finds out, the others learn here when its call has ended.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/engine.hpp"
#include "air/schedule.hpp"
#include "api/event_queue.hpp"
#include "api/sends.hpp"
#include "multicast/group_traffic.hpp"
#include "presence/admission.hpp"
#include "presence/presence.hpp"
#include "transport/flood.hpp"
#include "transport/forwarder.hpp"
#include "transport/stream_receivers.hpp"

namespace adhoc_communication {

class Engine::Implementation {
 public:
  static constexpr std::size_t kMostFloodOctets = 64'000;  ///< of one, unpacked; of a robot's words on groups, too

  Implementation(EngineOptions options, MacAddress address, BootId boot_id, std::uint64_t seed, Time now);

  void receive(const Frame& frame, Time now);
  SendId send(SendRequest request, Time now);
  SendId broadcast(BroadcastRequest request, Time now);
  std::vector<Frame> poll(Time now);
  void handed_over(bool kept) { air_.handed_over(kept); }
  /// Between two polls it changes by a touch only.
  Time next_deadline() const { return touched_ ? now_ : next_poll_; }
  std::optional<Event> next_event() { return events_.next(); }
  std::vector<Record> take_records();
  void join_group(const std::string& group, Time now);
  void leave_group(const std::string& group, Time now);
  void set_keys(std::vector<TeamKey> keys);

  // restart.cpp: another run of the same host.
  EngineOptions options() const;
  void succeed(Implementation& former, Time now);

  // introspection.cpp, tables.cpp: what a host may look at. Nothing here changes the engine.
  const Statistics& statistics() const { return statistics_; }
  const std::string& robot_name() const { return self_.name; }
  GroupState group_state(const std::string& group) const { return groups_.state(group, now_); }
  std::vector<std::string> neighbors() const;
  std::vector<std::string> robots() const { return directory_.names(); }
  std::vector<RouteState> routes() const;
  std::vector<TreeState> trees() const;
  std::vector<LinkState> links() const;
  QueueState queues() const;
  std::vector<std::string> groups() const { return groups_.groups(); }
  std::optional<std::string> name_of(const MacAddress& robot) const;
  std::vector<TableFill> tables() const;

 private:
  void touch(Time now) {
    now_ = now;
    touched_ = true;
  }
  void report(Event event) { events_.add(std::move(event)); }
  void malformed() { ++statistics_.frames_dropped.malformed; }

  // poll.cpp: what is due.
  Time next_due() const;
  void maintain(Time now);
  void announce_changes(Time now);
  void fail_unreachable(Time now);
  void link_lost(const MacAddress& neighbor, Time now);

  // frames.cpp: frames in.
  bool lost_artificially(wire::FrameType type);
  void ask_in_doubt(const MacAddress& robot, Time now);
  bool hear(const wire::FrameHeader& header, Time now);
  void dispatch(const wire::FrameHeader& header, wire::Reader body, Time now);
  void on_data(const MacAddress& from, wire::Data data, Time now);
  void on_transport_acknowledgment(const MacAddress& from, wire::TransportAcknowledgment acknowledgment, Time now);
  void on_broadcast_data(const wire::FrameHeader& header, const wire::BroadcastData& data, Time now);
  void on_flood(const wire::Flood& flood, Time now);

  // packets.cpp: packets put together.
  enum class Carrier { kStream, kBroadcast, kFlood, kGroup };
  bool admits(Carrier carrier, const std::string& source, const transport::Packet& packet) const;
  void deliver(Carrier carrier, const std::string& source, wire::BootTag boot, Bytes image, std::uint8_t hops,
               Time now);
  void take_group_packets(Time now);
  void deliver_data(const wire::Data& data, Time now);
  void forget_evicted(Time now);

  // sends.cpp: packets of the host, and letters of groups.
  SendId refuse(std::string reason);
  void start(SendId id, const transport::Image& image, Time now);
  bool take_place(SendId id, const std::string& topic, const transport::Image& image, Time now);
  bool replace(SendId former, SendId id, const transport::Image& image, Time now);
  void expire_sends(Time now);
  void cancel(SendId id, Time now);
  std::string cancel_group_send(SendId id, Time now);
  void finish(SendId id, bool delivered, const std::string& reason, Time now, bool superseded = false);
  void finish(const multicast::GroupSendEnd& end);
  void finish_floods();
  void settle_groups(Time now);

  void end(const std::string& reason, Time now);

  EngineOptions options_;
  Identity self_;
  Statistics statistics_;
  Journal journal_;
  security::FrameGuard guard_;
  Random random_;
  presence::BeaconRhythm rhythm_;
  routing::Neighbors neighbors_;
  routing::LivingRuns runs_;
  presence::Admission admission_;
  routing::RobotDirectory directory_;
  air::AirClock air_;
  air::Transmitter transmitter_;
  transport::Hops hops_;
  routing::Router router_;
  presence::Presence presence_;
  std::uint16_t broadcast_segment_size_;
  std::size_t longest_flood_;
  transport::Reassembly reassembly_;
  transport::Streams streams_;
  transport::StreamReceivers receivers_;
  transport::Forwarder forwarder_;
  transport::BroadcastSenders broadcasts_;
  transport::BroadcastReceiver broadcast_receiver_;
  transport::FloodRelay flood_;
  multicast::Carriage carriage_;
  multicast::Distributor distributor_;
  multicast::GroupTraffic groups_;
  air::Schedule schedule_;
  Sends sends_;
  EventQueue events_;

  std::uint32_t next_flood_id_ = 0;
  Time now_{0};
  Time next_poll_ = Time::max();
  bool touched_ = true;  ///< something came in since the last poll
};

}  // namespace adhoc_communication
