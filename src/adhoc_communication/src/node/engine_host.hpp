// Runs an engine on a link: one thread owns both, every other thread asks it and waits for the answer.
#pragma once

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "adhoc_communication/engine.hpp"
#include "link/link.hpp"
#include "node/channel_model.hpp"
#include "node/commands.hpp"

namespace adhoc_communication {

/// How a send or a change of membership ended. `reason` is a sentence for people, empty on success.
struct Outcome {
  bool succeeded = false;
  std::string reason;
  bool superseded = false;            ///< a newer packet has taken the place of this one
  std::vector<std::string> missed{};  ///< of a send to a group: the members that have not got it
};

/// What the host tells the node, always from the thread of the engine: these must return at once. Packets are as they
/// came, packed.
struct HostCallbacks {
  std::function<void(PacketReceived)> on_packet;
  std::function<void(const std::string& robot)> on_robot_appeared;
  std::function<void(const std::string& robot)> on_robot_lost;
  std::function<void(const std::string& text)> on_warning;
  std::function<void(const std::string& text)> on_failure{};      ///< the host is of no use any more
  std::function<void(const std::string& robot)> on_name_taken{};  ///< by two robots
  std::function<void(std::vector<Record> records, Time now)> on_records{};
};

/// Is told once how something ended, by the thread of the engine unless the host has stopped; returns at once.
using Waiter = std::function<void(const Outcome&)>;

/// What there is to see of the engine and its link at one moment.
struct Snapshot {
  Statistics statistics;
  std::vector<std::string> robots;
  std::vector<std::string> neighbors;
  std::vector<LinkState> links;
  std::vector<RouteState> routes;
  std::map<MacAddress, std::string> names;  ///< of the robots in `routes`, as far as known
  std::map<std::string, GroupState> groups;
  QueueState queues;
  bool link_up = false;
  MacAddress address{};
  std::uint64_t frames_not_sent = 0;  ///< that the link did not take
  std::uint64_t frames_missed = 0;    ///< that came while the link had no room for them
  Time now{0};
};

class EngineHost {
 public:
  EngineHost(const EngineOptions& options, std::unique_ptr<Link> link, ReceiveFilter filter, HostCallbacks callbacks);
  ~EngineHost();
  EngineHost(const EngineHost&) = delete;
  EngineHost& operator=(const EngineHost&) = delete;

  /// Ends the thread; calls that still wait return with the reason that the node shuts down.
  void stop();

  // Each waits until the engine has finished. Callable from any thread.
  Outcome send(SendRequest request);
  Outcome broadcast(BroadcastRequest request);
  Outcome join_group(const std::string& group);
  Outcome leave_group(const std::string& group);

  /// Does not wait, but packs the payload: not for the thread of the engine. Callable from any other.
  void send(SendRequest request, Waiter waiter);

  // Answered within one turn of the engine's loop.
  GroupState group_state(const std::string& group);
  std::vector<std::string> neighbors();
  Snapshot snapshot();

  /// The first one seals, all of them open.
  void set_keys(std::vector<TeamKey> keys);

 private:
  void run();
  void work();
  bool wait_for_work();
  void receive_frames();
  void transmit(Time now);
  void report_events();
  void report_records();
  void tend_link(Time now);
  void tell_link_state();
  void restart_engine(Time now);
  void report(PacketReceived& packet);
  void report(const SendFinished& end);
  void report(const RobotAppeared& event);
  void report(const RobotLost& event);
  void report(const NameTaken& event);
  void report(const GroupChangeFinished& end);
  void fail_all();
  Snapshot look() const;

  template <typename Value>
  Value ask(std::function<Value()> question);
  Outcome wait_for(const std::function<void(Time, Waiter)>& begin);

  std::unique_ptr<Link> link_;
  ReceiveFilter filter_;
  HostCallbacks callbacks_;
  MacAddress address_;  ///< for which the engine runs, as mtu_
  int mtu_;
  Time engine_time_;  ///< what the engine was told last; never goes back
  Engine engine_;
  Commands commands_;
  std::map<SendId, Waiter> sends_;
  std::multimap<std::pair<std::string, bool>, Waiter> group_changes_;  ///< by group and whether it is to be joined
  bool link_was_up_ = true;
  std::string trouble_told_;
  Time next_tending_{0};

  std::thread thread_;
};

}  // namespace adhoc_communication
