// A radio in the memory of one process: reach, loss, air time. No clock, no socket; time is an argument.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "address_map.hpp"
#include "adhoc_communication/types.hpp"
#include "medium/bursts.hpp"
#include "medium/contention.hpp"
#include "medium/options.hpp"
#include "medium/reach.hpp"
#include "medium/turns.hpp"
#include "random.hpp"

namespace adhoc_communication {

/// Frames of a node go out one after another. A frame reaches, at the end of its air time, the nodes in range that it
/// is addressed to. A node whose position is unknown is in range of everybody. docs/medium.md tells the whole model.
class Medium {
 public:
  using Node = std::size_t;
  using SharedFrame = std::shared_ptr<const Frame>;  ///< of all that hear it

  struct Delivery {
    Node node;
    SharedFrame frame;
  };

  struct Counters {
    std::uint64_t frames = 0;  ///< transmitted
    std::uint64_t octets = 0;
    std::uint64_t delivered = 0;
    std::uint64_t lost = 0;       ///< by chance
    std::uint64_t collided = 0;   ///< destroyed at a receiver by another frame
    std::uint64_t unheard = 0;    ///< the receiver was sending itself
    std::uint64_t discarded = 0;  ///< queue full, or the sender was down
    std::uint64_t repeated = 0;   ///< by the link layer; each counts as a frame, too
    Time air_time{0};
  };

  /// Throws std::invalid_argument with one sentence.
  Medium(const MediumOptions& options, std::uint64_t seed);

  /// The address may be left out: it is learned from the first frame the node sends.
  Node add_node(const std::string& name, std::optional<MacAddress> address = std::nullopt);
  std::optional<Node> find(const std::string& name) const;
  const std::string& name(Node node) const { return nodes_.at(node).name; }
  std::size_t node_count() const { return nodes_.size(); }

  /// Throws std::invalid_argument beyond 1e9 m.
  void set_position(Node node, double x, double y);
  /// Without effect if path_loss decides.
  void set_range(double metres) { reach_.set_range(metres); }
  void set_loss(double probability) { reach_.set_loss(probability); }
  /// Of frames that go on the air from now on. Throws std::invalid_argument if it is not above zero.
  void set_bit_rate(double bit_rate);
  /// Both directions; 1 cuts the link, nothing gives it back to the model of distance and common loss.
  void set_link_loss(Node a, Node b, std::optional<double> probability);
  /// Only frames from `from` to `to`.
  void set_one_way_loss(Node from, Node to, std::optional<double> probability);
  /// A node that is down neither sends nor receives; what it has queued is lost.
  void set_up(Node node, bool up, Time now);

  void transmit(Node node, Frame frame, Time now);
  /// Whether the node has frames that have not left it.
  bool keeps_frames(Node node) const { return nodes_.at(node).queued > 0; }
  /// When something happens next: deliveries() is due then, though nothing may arrive.
  std::optional<Time> next_delivery() const;
  /// What has arrived until `now`, in order.
  std::vector<Delivery> deliveries(Time now);

  const Counters& counters() const { return counters_; }
  const Counters& counters(Node node) const { return nodes_.at(node).counters; }
  bool in_range(Node a, Node b) const { return reach_.in_range(a, b); }
  const MediumOptions& options() const { return reach_.options(); }

 private:
  struct NodeState {
    std::string name;
    std::optional<MacAddress> address;
    bool up = true;
    std::uint64_t life = 0;  ///< changes whenever the node goes down
    Time busy_until{0};
    std::size_t queued = 0;
    std::deque<SharedFrame> waiting;  ///< for a free channel, where it is contended for
    std::optional<Time> attempt;      ///< when the node tries to send the first of them
    int retries = 0;                  ///< of that one
    Time latest{0};                   ///< for which a frame to it is due that was delayed
    Counters counters;
  };
  struct Flight {
    Node sender;
    std::uint64_t life;
    SharedFrame frame;
    Time begin;
    Time end;
    bool first = true;              ///< false for the late or second copy that reordering and duplication make
    std::vector<Node> overlapping;  ///< senders of frames that were on the air at the same time, if it is contended for
  };

  using FlightKey = std::pair<Time, std::uint64_t>;  ///< end of air time, order of transmission

  /// Received, and on its way from the radio to the robot.
  struct Delayed {
    std::uint64_t life;  ///< of the receiver
    Delivery delivery;
  };

  /// Sends at the node's turn.
  void take_turn(Node node, SharedFrame frame, Time now);
  Time air_time(Node sender, const Frame& frame);
  double bit_rate(Node sender, const Frame& frame);
  bool is_repeated(const Frame& frame) const;
  FlightKey launch(Node sender, SharedFrame frame, Time begin, Time duration);
  void back_off(Node node, Time idle_from);
  void attempt(Node node, Time at);
  void land(Time at, std::vector<Delivery>& out);
  void arrive(Flight& flight, Time at, std::vector<Delivery>& out);
  /// Whether the robot that it is for has got it.
  bool deliver(const Flight& flight, Time at, std::vector<Delivery>& out);
  bool lost(const Flight& flight, const Hearer& receiver, Time at);
  void hand_over(Delivery delivery, Time at, std::vector<Delivery>& out);
  void take_delayed(std::vector<Delivery>& out);
  void go_on(Node sender, Time at);
  bool try_again(const Flight& flight, Time at);
  bool repeat_or_delay(const Flight& flight, Time at);  ///< true if the frame itself arrives later
  bool survives(const Flight& flight, const Hearer& receiver);
  void count(Node sender, std::uint64_t Counters::*counter);
  bool addressed(const Frame& frame, const NodeState& node) const;
  SharedFrame corrupted(Frame frame);

  Random random_;
  Reach reach_;
  ContendedChannel channel_;
  Turns turns_;
  Bursts bursts_;
  std::vector<NodeState> nodes_;
  AddressMap<Node> by_address_;
  std::map<FlightKey, Flight> flights_;
  std::multimap<Time, Delayed> delayed_;
  std::set<std::pair<Time, Node>> attempts_;
  std::uint64_t next_flight_ = 0;
  Time shared_busy_until_{0};
  Counters counters_;
};

}  // namespace adhoc_communication
