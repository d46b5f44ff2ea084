// Who is heard on the radio, and who of them hears this robot.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "routing/timings.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::routing {

struct Neighbor {
  wire::BootTag boot = 0;
  Time last_heard{0};
  std::optional<Time> listed;     ///< when it last said that it hears this robot
  std::vector<MacAddress> hears;  ///< as of its last beacon
  double loss = 0.0;              ///< estimate for frames to it, 0..1
};

/// At most kMostNeighbors; further robots are not taken in until one falls silent.
class Neighbors {
 public:
  static constexpr std::size_t kMostNeighbors = 250;

  explicit Neighbors(const Timings& timings) : timings_(timings) {}

  /// A robot heard that has not proved yet that it is alive now: it is only listed in beacons. False when it was listed
  /// already, or there is no room.
  bool candidate(const MacAddress& address, wire::BootTag boot, Time now);
  /// Any frame. Null when the table is full.
  Neighbor* heard(const MacAddress& address, wire::BootTag boot, Time now);
  void beacon(const MacAddress& address, const wire::Beacon& beacon, const wire::HeardNeighbor& self, Time now);
  /// The link failed: frames over it go unanswered until the neighbour says anew that it hears this robot.
  void link_failed(const MacAddress& address);

  const Neighbor* find(const MacAddress& address) const;
  /// Section 6.8: only links that work both ways carry routes.
  bool two_way(const MacAddress& address, Time now) const;
  std::vector<MacAddress> all_two_way(Time now) const;
  /// Those to list in a beacon, at most `most`, the latest heard first when there are more.
  std::vector<wire::HeardNeighbor> heard_list(std::size_t most, Time now) const;
  /// Every neighbour whose link works both ways hears `robot` itself, or is it.
  bool all_hear(const MacAddress& robot, Time now) const;
  /// Removes and returns those silent for longer than `timeout`.
  std::vector<MacAddress> remove_silent(Time timeout, Time now);
  /// Those whose silence has just ended their routes.
  std::vector<MacAddress> newly_silent(Time now);

  const std::map<MacAddress, Neighbor>& all() const { return neighbors_; }
  std::size_t candidates() const { return candidates_.size(); }
  void set_loss(const MacAddress& address, double loss);

 private:
  const Timings& timings_;
  std::map<MacAddress, Neighbor> neighbors_;
  std::map<std::pair<MacAddress, wire::BootTag>, Time> candidates_;  ///< when they were heard last
};

}  // namespace adhoc_communication::routing
