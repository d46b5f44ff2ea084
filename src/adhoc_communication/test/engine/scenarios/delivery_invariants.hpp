// The promises about packets: nothing altered, nothing twice, order kept, one end for every send, and "delivered" is
// true; what is too large is refused, and nothing else for that reason.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "scenario.hpp"
#include "violation.hpp"

namespace adhoc_communication {

class DeliveryInvariants {
 public:
  static constexpr Time kPatience = std::chrono::seconds(60);  ///< within which every send has to end
  /// The engine promises an end after so much silence (`num_e2e_retrans` questions, a second each at most), not after
  /// so much time. Where hops repeat nothing, each segment may take that long, and those behind it wait.
  static constexpr Time kSilence = std::chrono::seconds(11);
  static constexpr std::size_t kSmallestSegment = 256;

  /// `largest_packet`: EngineOptions::max_packet_size.
  explicit DeliveryInvariants(std::size_t robots, bool hops_repeat = true,
                              std::size_t largest_packet = EngineOptions().max_packet_size)
      : hops_repeat_(hops_repeat), largest_packet_(largest_packet), runs_(robots, 0) {}

  void booted(std::size_t robot) { ++runs_[robot]; }
  void crashed(std::size_t robot);

  /// What a robot is about to send. The topic names the packet wherever it turns up.
  SendRequest request(const Action& action, Time now);
  BroadcastRequest flood(const Action& action, Time now);
  /// The engine has accepted the latest of them under this id. `owed`: for a group, the robots that are in it.
  void accepted(SendId id, std::set<std::size_t> owed);
  /// There is a path for the latest one: a failure would break A13.3.
  void latest_has_to_arrive() { packets_.back().has_to_arrive = true; }

  /// Throws Violation.
  void received(std::size_t robot, const PacketReceived& packet);
  void finished(std::size_t robot, const SendFinished& end, Time now);
  /// Members of the group of `root` now: only who stays one until the send ends is owed the packet.
  void members(std::size_t root, const std::set<std::size_t>& members);
  /// The robot takes nothing more that is sent to that group.
  void left(std::size_t robot, std::size_t root);
  bool awaits_group(std::size_t root) const;

  /// Sends whose end is still to come.
  std::size_t open() const { return open_.size(); }
  void check_patience(Time now) const;
  std::size_t sends() const { return packets_.size(); }
  std::size_t delivered() const { return delivered_; }

 private:
  struct Packet {
    Action action;
    int run = 0;  ///< of the sender
    std::string group;
    std::string topic;
    std::uint8_t payload_type = 0;
    Bytes payload;
    Time sent{0};
    std::set<std::size_t> owed;                         ///< members that have to have it when it ends
    std::set<std::pair<std::size_t, int>> received_by;  ///< robot and its run
    bool has_to_arrive = false;
    bool too_large = false;
  };
  using SendKey = std::tuple<std::size_t, int, SendId>;  ///< robot, its run
  /// Receiver and its run, sender and its run, priority, destination.
  using Stream = std::tuple<std::size_t, int, std::size_t, int, Priority, std::string>;

  std::size_t add(const Action& action, Time now);
  void check_addressee(std::size_t robot, const Packet& packet) const;
  void check_order(std::size_t robot, const Packet& packet, std::size_t number);
  bool has(std::size_t robot, const Packet& packet) const;
  Time latest_end(const Packet& packet) const;

  const bool hops_repeat_;
  const std::size_t largest_packet_;
  std::vector<int> runs_;
  std::vector<Packet> packets_;
  std::map<SendKey, std::size_t> open_;
  std::set<SendKey> over_;
  std::map<Stream, std::size_t> latest_;
  std::map<std::pair<std::size_t, Priority>, Time> ended_at_;  ///< when a send of that robot and priority ended last
  std::size_t delivered_ = 0;
};

}  // namespace adhoc_communication
