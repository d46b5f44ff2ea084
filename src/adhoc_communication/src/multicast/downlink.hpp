// Packets to the children: frames, questions, and what the children report.
#pragma once

#include <optional>
#include <vector>

#include "multicast/branches.hpp"
#include "multicast/group_frame.hpp"
#include "multicast/sink.hpp"
#include "outbox.hpp"

namespace adhoc_communication::multicast {

class Downlink {
 public:
  Downlink(Outbox& outbox, Branches& branches, const Carriage& carriage)
      : outbox_(outbox), branches_(branches), carriage_(carriage) {}

  /// Asks children that owe an answer. Returns those that are of no use any more.
  /// `base`: the packets before are finished at the root.
  std::vector<MacAddress> ask(const Place& place, std::uint32_t base, const std::set<MacAddress>& behind, Time now);
  bool has_frame(std::uint8_t priority) const;
  /// From whom the frames come that wait; all zero for those of the own group.
  void add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const;
  /// The packet whose turn it is, of those that came from there; one root after the other.
  std::optional<Place> next(std::uint8_t priority, const MacAddress& previous_hop);
  GroupFrame frame(const Place& place, std::uint32_t base, const std::optional<MacAddress>& follows, Time now);

 private:
  static wire::GroupData header(const Place& place, std::uint32_t base);

  Outbox& outbox_;
  Branches& branches_;
  const Carriage& carriage_;
  MacAddress last_root_served_{};
};

}  // namespace adhoc_communication::multicast
