// One group packet at one robot, and the packets of one priority in their order.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "multicast/distribution.hpp"
#include "routing/sequence_number.hpp"
#include "transport/packet_image.hpp"
#include "transport/reassembly.hpp"

namespace adhoc_communication::multicast {

struct Transfer {
  std::unique_ptr<GroupPacket> packet;
  std::unique_ptr<Distribution> to_children;
  std::optional<transport::Reassembly::Key> room;  ///< not at the root, which holds the packet anyway
  std::uint8_t hops = 1;                           ///< from the root to this robot
  std::uint16_t round = 0;                         ///< greatest one heard from upstream
  std::optional<Time> report_due;
  std::optional<std::pair<std::uint32_t, std::uint32_t>> told;  ///< epoch and coverage of the last report "complete"
  Time last_news{0};
  // At the root only.
  SendId id = 0;
  transport::Image image;
  std::set<MacAddress> open;  ///< members that do not have it yet
};

/// Packets of one priority from one root. Delivered in order; a packet that the root has given up is passed over.
struct GroupStream {
  using Transfers = std::map<std::uint32_t, Transfer, routing::SequenceOrder>;
  bool started = false;
  std::uint32_t next = 0;             ///< at the root: number of the next packet; elsewhere: next one to deliver
  std::optional<std::uint32_t> base;  ///< packets before are finished at the root; not known from copies
  /// At the root: numbers on their way to members by themselves.
  std::multiset<std::uint32_t, routing::SequenceOrder> copies;
  Transfers transfers;
  Time told_no_room{-1};  ///< last
};

}  // namespace adhoc_communication::multicast
