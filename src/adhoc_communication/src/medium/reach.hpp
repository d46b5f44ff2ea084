// Who hears whom on a Medium, and how well.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "medium/grid.hpp"
#include "medium/options.hpp"
#include "medium/shadowing.hpp"
#include "propagation/position.hpp"

namespace adhoc_communication {

/// A node that hears another.
struct Hearer {
  std::size_t node;
  double loss;   ///< probability that a frame is lost, below 1
  double power;  ///< dBm received
};

/// The hearers of each node are worked out once and kept until anything moves or changes.
class Reach {
 public:
  using Node = std::size_t;

  Reach(const MediumOptions& options, std::uint64_t seed);

  const MediumOptions& options() const { return options_; }
  double threshold() const { return threshold_; }  ///< weakest power received, dBm

  void add_node();
  void set_position(Node node, const Position& position);
  void set_range(double metres);
  void set_loss(double probability);
  void set_bit_rate(double bit_rate) { options_.bit_rate = bit_rate; }
  void set_link_loss(Node from, Node to, std::optional<double> probability);

  /// In the order of their numbers. Valid until the next change.
  const std::vector<Hearer>& hearers(Node sender);
  /// `receiver` as a hearer of `sender`, nullptr if it is none.
  const Hearer* hearer(Node sender, Node receiver);
  /// False only if certainly nobody hears both.
  bool may_meet(Node a, Node b) const;
  /// By position alone. A node without one is in range of everybody.
  bool in_range(Node a, Node b) const;

 private:
  struct Place {
    std::optional<Position> position;
    double shadowing = 0.0;
    std::vector<Hearer> hearers;
    std::uint64_t version = 0;  ///< for which the hearers hold
  };

  bool is_plain() const;  ///< nothing counts but the distance
  double farthest() const;
  double power_between(const Place& a, const Place& b) const;
  double power_at(double distance, const Place& a, const Place& b) const;
  std::optional<double> power_if_in_range(const Place& a, const Place& b) const;
  void make_grid();
  void find_hearers(Node sender, std::vector<Hearer>& hearers);
  void apply_link_losses(Node sender, std::vector<Hearer>& hearers) const;

  MediumOptions options_;
  PathLoss path_loss_;
  double threshold_ = 0.0;
  double farthest_ = 0.0;  ///< metres beyond which no frame is received
  Shadowing shadowing_;
  std::vector<Place> places_;
  std::vector<Node> unplaced_;
  NeighborGrid grid_;
  std::map<std::pair<Node, Node>, double> link_loss_;
  std::uint64_t version_ = 1;
  std::vector<Node> candidates_;  ///< memory to work with
};

}  // namespace adhoc_communication
