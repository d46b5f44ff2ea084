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

/// The room of a packet that is being put together, given back with it.
class Room {
 public:
  Room(transport::Reassembly& reassembly, const transport::Reassembly::Key& key) : reassembly_(reassembly), key_(key) {}
  ~Room() { reassembly_.release(key_); }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  void progress(std::size_t octets, Time now) { reassembly_.progress(key_, octets, now); }
  /// The packet is complete; `done_with`: nothing is left to do with it here.
  void complete(bool done_with, Time now) {
    if (std::exchange(done_with_, done_with) == done_with) return;
    done_with ? reassembly_.spare(key_) : reassembly_.keep(key_, now);
  }

 private:
  transport::Reassembly& reassembly_;
  transport::Reassembly::Key key_;
  std::optional<bool> done_with_{};  ///< nothing before the packet is complete
};

/// What upstream was told of a packet that is complete here and at all behind: for which members.
struct Told {
  std::uint32_t epoch = 0;
  std::uint32_t coverage = 0;

  friend bool operator==(const Told& a, const Told& b) { return a.epoch == b.epoch && a.coverage == b.coverage; }
};

struct Transfer {
  std::unique_ptr<GroupPacket> packet;
  std::unique_ptr<Distribution> to_children;
  std::unique_ptr<Room> room;  ///< none at the root, which holds the packet anyway
  bool flooded = false;        ///< everybody passes it on; no tree carries it
  std::uint8_t hops = 1;       ///< from the root to this robot
  std::uint16_t round = 0;     ///< greatest one heard from upstream
  std::optional<Time> report_due;
  std::optional<Told> told;  ///< in the last report "complete"
  Time last_news{0};
  // At the root only.
  SendId id = 0;
  transport::Image image;
  std::set<MacAddress> open;   ///< members that do not have it yet
  std::set<MacAddress> there;  ///< of a flooded one: of these, those where it waits for packets before it
  Time sent{0};                ///< of a flooded one
  Time late{0};                ///< of a flooded one: when members of which nothing was heard are served by themselves
  std::map<MacAddress, Time> missed;  ///< and those that have a later packet, since when that is known
};

/// Packets of one priority from one root. Delivered in order; a packet that the root has given up is passed over. It
/// begins with the first frame at a place in the tree, or with a copy: what is heard before says nothing of the order.
struct GroupStream {
  using Transfers = std::map<std::uint32_t, Transfer, routing::SequenceOrder>;
  bool started = false;
  std::uint32_t next = 0;              ///< at the root: number of the next packet; elsewhere: next one to deliver
  std::optional<std::uint32_t> base;   ///< packets before are finished at the root; not known from copies
  std::optional<std::uint32_t> early;  ///< that of the first frame heard without a place, while there is none
  Transfers transfers;
  std::uint8_t flood_hops = 0;  ///< that the latest flooded packet has come over; 0: there was none
  std::vector<std::pair<std::uint32_t, Told>> done;  ///< packets that made room when they were done with; latest last
  Time told_no_room{-1};                             ///< last
};

/// Whether packet `a` comes before packet `b` of its stream.
inline bool before(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

}  // namespace adhoc_communication::multicast
