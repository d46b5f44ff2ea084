// The protocol engine of one robot: no ROS, no socket, no thread, no clock, no global random generator.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "adhoc_communication/records.hpp"
#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// Five calls drive it: receive, send, poll, next_deadline, next_event. The host calls poll() after every receive()
/// and send(), and again at next_deadline(), and puts the frames that poll() returns on the air.
class Engine {
 public:
  /// Throws std::invalid_argument naming the option that is out of range.
  Engine(EngineOptions options, MacAddress address, BootId boot_id, std::uint64_t seed, Time now);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  /// A frame heard on the link. Anything malformed, foreign or not addressed to this robot is counted and dropped.
  void receive(const Frame& frame, Time now);

  /// Accepts a packet; its end is reported by one SendFinished. A request that cannot be tried at all (own name, empty
  /// topic, larger than max_packet_size, queue full) finishes at once with the reason.
  SendId send(SendRequest request, Time now);
  SendId broadcast(BroadcastRequest request, Time now);

  /// Does what is due and returns the frames to transmit now, in order.
  std::vector<Frame> poll(Time now);

  /// To be called when what poll() returned was handed to the device, with whether something of it is there still: the
  /// air was busy, or is slower than the robot. Without it the engine never takes the channel for shared.
  void handed_over(bool kept);

  /// When poll() has to be called next at the latest. Time::max() when nothing is due.
  Time next_deadline() const;

  std::optional<Event> next_event();

  /// What has happened since the last call, if the options ask for it; to be taken after each poll().
  std::vector<Record> take_records();

  void join_group(const std::string& group, Time now);
  void leave_group(const std::string& group, Time now);
  GroupState group_state(const std::string& group) const;

  /// The interface has another address, or carries frames of another size: a new run begins. What is under way fails,
  /// all robots are lost, and groups that the host has joined or left are remembered. Throws std::invalid_argument, and
  /// goes on as before, when frames of that size cannot be used.
  void restart(MacAddress address, int mtu, BootId boot_id, std::uint64_t seed, Time now);

  /// Changes the keys while frames flow: the first one seals, all of them open. Throws std::invalid_argument when that
  /// would turn sealing on or off.
  void set_keys(std::vector<TeamKey> keys);

  std::vector<std::string> neighbors() const;  ///< direct neighbours
  std::vector<std::string> robots() const;     ///< all known robots, also over several hops
  const Statistics& statistics() const;
  const std::string& robot_name() const;
  std::vector<RouteState> routes() const;  ///< the routing table, for diagnosis and tests
  std::vector<TreeState> trees() const;
  std::vector<TableFill> tables() const;  ///< everything that grows, with its bound

  // What hosts may look at.
  std::vector<LinkState> links() const;                         ///< one per neighbour
  QueueState queues() const;                                    ///< what waits, and how much of it
  std::vector<std::string> groups() const;                      ///< the own group and those joined or being joined
  std::optional<std::string> name_of(const MacAddress&) const;  ///< of a robot known

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace adhoc_communication
