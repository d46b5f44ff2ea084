// A radio in the memory of one process: range, loss, air time. No clock, no socket; time is an argument.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "random.hpp"

namespace adhoc_communication {

struct MediumOptions {
  double range = 10.0;                                  ///< metres; robots farther apart do not hear each other
  double loss = 0.0;                                    ///< probability per frame and receiver
  double bit_rate = 50e6;                               ///< bit/s for the octets behind the Ethernet header
  Time frame_overhead = std::chrono::microseconds(50);  ///< air time of a frame besides its octets
  bool shared = false;             ///< all nodes take turns on one channel; otherwise each has its own to send on
  std::size_t queue_limit = 1000;  ///< frames of a node waiting for the air; further ones are lost
  double duplication = 0.0;        ///< probability that a frame arrives twice
  double reordering = 0.0;         ///< probability that a frame arrives up to 5 ms late
  double corruption = 0.0;         ///< probability that one octet of a frame is altered
};

/// Frames of a node go out one after another. A frame reaches, at the end of its air time, the nodes in range that it
/// is addressed to. A node whose position is unknown is in range of everybody.
class Medium {
 public:
  using Node = std::size_t;

  struct Delivery {
    Node node;
    Frame frame;
  };

  struct Counters {
    std::uint64_t frames = 0;  ///< transmitted
    std::uint64_t octets = 0;
    std::uint64_t delivered = 0;
    std::uint64_t lost = 0;       ///< by chance
    std::uint64_t discarded = 0;  ///< queue full, or the sender was down
    Time air_time{0};
  };

  Medium(const MediumOptions& options, std::uint64_t seed);

  /// The address may be left out: it is learned from the first frame the node sends.
  Node add_node(const std::string& name, std::optional<MacAddress> address = std::nullopt);
  std::optional<Node> find(const std::string& name) const;
  const std::string& name(Node node) const { return nodes_.at(node).name; }
  std::size_t node_count() const { return nodes_.size(); }

  void set_position(Node node, double x, double y);
  void set_range(double metres) { options_.range = metres; }
  void set_loss(double probability) { options_.loss = probability; }
  /// Both directions; 1 cuts the link, nothing gives it back to the model of distance and common loss.
  void set_link_loss(Node a, Node b, std::optional<double> probability);
  /// Only frames from `from` to `to`.
  void set_one_way_loss(Node from, Node to, std::optional<double> probability);
  /// A node that is down neither sends nor receives; what it has queued is lost.
  void set_up(Node node, bool up, Time now);

  void transmit(Node node, const Frame& frame, Time now);
  /// When the next frame arrives somewhere.
  std::optional<Time> next_delivery() const;
  /// What has arrived until `now`, in order.
  std::vector<Delivery> deliveries(Time now);
  /// When the air is free for a further frame of this node.
  Time free_at(Node node) const;

  const Counters& counters() const { return counters_; }
  const Counters& counters(Node node) const { return nodes_.at(node).counters; }
  bool in_range(Node a, Node b) const;

 private:
  struct NodeState {
    std::string name;
    std::optional<MacAddress> address;
    std::optional<std::pair<double, double>> position;
    bool up = true;
    std::uint64_t life = 0;  ///< changes whenever the node goes down
    Time busy_until{0};
    std::size_t queued = 0;
    Counters counters;
  };
  struct Flight {
    Node sender;
    std::uint64_t life;
    Frame frame;
    bool first = true;  ///< false for the late or second copy that reordering and duplication make
  };

  double loss_between(Node from, Node to) const;
  bool addressed(const Frame& frame, const NodeState& node) const;
  void arrive(const Flight& flight, Time at, std::vector<Delivery>& out);
  void corrupt(Bytes& bytes);

  MediumOptions options_;
  Random random_;
  std::vector<NodeState> nodes_;
  std::map<std::pair<Node, Node>, double> link_loss_;
  std::map<std::pair<Time, std::uint64_t>, Flight> flights_;  ///< by end of air time and order of transmission
  std::uint64_t next_flight_ = 0;
  Time shared_busy_until_{0};
  Counters counters_;
};

}  // namespace adhoc_communication
