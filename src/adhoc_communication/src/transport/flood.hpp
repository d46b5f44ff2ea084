// Packets in one frame for everybody within some hops: passed on once by each robot, after a short random delay.
#pragma once

#include <deque>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "outbox.hpp"
#include "random.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

/// At most kMostSeen floods are remembered, for as long as there is room: somebody may have recorded one. The oldest
/// makes room.
class FloodRelay {
 public:
  static constexpr std::size_t kMostSeen = 1024;
  static constexpr std::size_t kMostUnpacked = 64'000;  ///< octets of one; of a robot's words on groups, too
  static constexpr std::size_t kMostPending = 256;      ///< further floods are not passed on
  static constexpr std::size_t kMostWaiting = 64;       ///< own ones; further ones are refused
  static constexpr Time kJitter = std::chrono::milliseconds(10);

  FloodRelay(Outbox& outbox, Random& random) : outbox_(outbox), random_(random) {}

  /// An own flood, which waits until the radio has room for it, but not longer than its lifetime (0: none). False when
  /// too many do.
  bool originate(SendId id, Bytes body, Time lifetime, Time now);
  /// Those that have not gone out, and will not any more.
  std::vector<SendId> take_waiting();
  /// Those that went out.
  std::vector<SendId> take_sent() { return std::exchange(sent_, {}); }
  /// Those that have waited too long, and how long they might have.
  std::vector<std::pair<SendId, Time>> take_overdue() { return std::exchange(overdue_, {}); }
  /// True when the flood is new; it is then passed on if its hop limit allows.
  bool take(const wire::Flood& flood, Time now);
  void poll(Time now);
  Time next_deadline() const;
  std::size_t remembered() const { return seen_.size(); }

 private:
  using Key = std::tuple<MacAddress, wire::BootTag, std::uint32_t>;
  struct Waiting {
    SendId id;
    Bytes body;
    Time lifetime;
    Time until;
  };

  void drop_overdue(Time now);

  Outbox& outbox_;
  Random& random_;
  std::map<Key, Time> seen_;
  std::vector<std::pair<Time, wire::Flood>> pending_;
  std::deque<Waiting> waiting_;
  std::vector<SendId> sent_;
  std::vector<std::pair<SendId, Time>> overdue_;
};

}  // namespace adhoc_communication::transport
