// The layers of the engine put together. What one of them finds out, the others learn here when its call has ended.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/engine.hpp"
#include "air/lost_links.hpp"
#include "air/reception.hpp"
#include "air/schedule.hpp"
#include "api/incoming.hpp"
#include "api/introspection.hpp"
#include "api/outgoing.hpp"

namespace adhoc_communication {

class Engine::Implementation {
 public:
  Implementation(EngineOptions options, MacAddress address, BootId boot_id, std::uint64_t seed, Time now);

  void receive(const Frame& frame, Time now) {
    touched(now);
    reception_.receive(frame, now);
  }
  SendId send(SendRequest request, Time now) {
    touched(now);
    return outgoing_.send(std::move(request), now);
  }
  SendId broadcast(BroadcastRequest request, Time now) {
    touched(now);
    return outgoing_.broadcast(std::move(request), now);
  }
  void join_group(const std::string& group, Time now) {
    touched(now);
    outgoing_.join(group, now);
  }
  void leave_group(const std::string& group, Time now) {
    touched(now);
    outgoing_.leave(group, now);
  }
  std::vector<Frame> poll(Time now);
  void handed_over(bool kept) { air_.handed_over(kept); }
  /// Between two polls it changes by a call of the host only.
  Time next_deadline() const { return touched_ ? now_ : next_poll_; }
  std::optional<Event> next_event() { return events_.next(); }
  std::vector<Record> take_records();

  // restart.cpp: another run of the same host.
  EngineOptions options() const;
  void succeed(Implementation& former, Time now);
  void set_keys(std::vector<TeamKey> keys);

  const Introspection& look() const { return introspection_; }
  Time now() const { return now_; }
  const Statistics& statistics() const { return statistics_; }
  const std::string& robot_name() const { return self_.name; }

 private:
  void touched(Time now) {
    now_ = now;
    touched_ = true;
  }

  // poll.cpp: what is due.
  Time next_due() const;
  void maintain(Time now);
  void announce_changes(Time now);
  void fail_unreachable(Time now);

  EngineOptions options_;
  Identity self_;
  Statistics statistics_;
  Journal journal_;
  EventQueue events_;
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
  air::LostLinks links_;
  Outgoing outgoing_;
  Incoming incoming_;
  air::Reception reception_;
  Introspection introspection_;

  Time now_{0};
  Time next_poll_ = Time::max();
  bool touched_ = true;  ///< something came in since the last poll
};

}  // namespace adhoc_communication
