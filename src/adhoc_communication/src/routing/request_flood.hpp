// RFC 3561 sections 6.3 and 6.5: which route requests were seen, and passing them on.
//
// A lost broadcast is the weak point of a flood. So whoever has broadcast a request listens; a neighbour that has not
// been heard with it after kConfirm, and hardly hears others who have it, gets it once more as an acknowledged unicast,
// unless it would not pass it on. Where the broadcast would be for one neighbour alone, and that may miss it, it gets
// such a unicast in place of it.
// While requests come thick and fast nobody gets such copies, and of those who hear one from several the others are
// silent: searches are repeated, and air that floods have taken is lost to all.
// On a crowded channel requests wait until the radio has room, and so do others: whoever had to wait gives them more
// time.
#pragma once

#include <boost/container/flat_set.hpp>
#include <deque>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "outbox.hpp"
#include "random.hpp"
#include "routing/neighbors.hpp"
#include "routing/request_load.hpp"

namespace adhoc_communication::routing {

/// At most kMostRequests are remembered; the one that would be forgotten first makes room.
class RequestFlood {
 public:
  static constexpr std::size_t kMostRequests = 1024;
  static constexpr std::size_t kMostPending = 256;      ///< further requests are not passed on
  static constexpr std::size_t kMostConfirmations = 6;  ///< unicast copies of one request
  static constexpr std::size_t kFewestHolders = 2;      ///< heard before an own copy is needless
  static constexpr std::size_t kEnoughHolders = 3;      ///< while requests come thick and fast
  static constexpr std::size_t kEnoughWays = 2;         ///< round a neighbour's link, so that it needs no unicast copy
  static constexpr double kTolerableMiss = 0.1;         ///< of all copies but the own, by a neighbour
  static constexpr int kMostForwards = 2;               ///< of one request: once more when a cheaper copy came late
  static constexpr Time kConfirm = std::chrono::milliseconds(25);
  static constexpr Time kConfirmJitter = std::chrono::milliseconds(10);  ///< on top, or copies of hidden robots collide
  static constexpr int kWaitersPerHop = 4;  ///< that may stand before a copy where this robot stood alone
  static constexpr Time kJitter = std::chrono::milliseconds(2);
  static constexpr Time kPenalty = std::chrono::milliseconds(7);  ///< for each transmission more than a perfect hop
  static constexpr Time kLongestPenalty = std::chrono::milliseconds(20);

  /// `hops_acknowledge`: unicasts are repeated until they arrive.
  RequestFlood(const Timings& timings, bool hops_acknowledge, Outbox& outbox, Random& random)
      : timings_(timings), hops_acknowledge_(hops_acknowledge), outbox_(outbox), random_(random) {}

  /// Notes that `from` has the request. True when it is new to this robot.
  bool first_time(const wire::RouteRequest& request, const MacAddress& from, Time now);
  /// Broadcasts an own request now.
  void originate(const wire::RouteRequest& request, const MacAddress& self, Time now);
  /// Broadcasts a request of another after a short random delay, longer when it came over a lossy link: so the copy
  /// over clean links wins the race. A cheaper copy takes the place of one that waits.
  void forward(const wire::RouteRequest& request, Cost link, Time now);

  void poll(const Neighbors& neighbors, Time now);
  Time next_deadline() const;
  const RequestLoad& load() const { return load_; }
  std::size_t remembered() const { return seen_.size(); }
  /// Neighbours that the request was heard from.
  int copies(const wire::RouteRequest& request) const {
    const auto seen = seen_.find(key(request));
    return seen == seen_.end() ? 0 : static_cast<int>(seen->second.holders.size());
  }

 private:
  using Key = std::tuple<MacAddress, wire::BootTag, std::uint32_t>;  ///< originator, its run, which counts from 0, id
  static Key key(const wire::RouteRequest& request) {
    return {request.originator, request.originator_boot, request.id};
  }
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      const auto& [originator, boot, id] = key;
      return static_cast<std::size_t>((originator.number() ^ boot) * 0x9e3779b97f4a7c15u + id);
    }
  };
  struct Seen {
    Time forgotten{0};
    int forwards = 0;
    boost::container::flat_set<MacAddress> holders;
  };
  struct Pending {
    Time due{0};
    bool broadcast_done = false;
    wire::RouteRequest request;
  };

  void make_room(Time now);
  void confirm(const wire::RouteRequest& request, const Neighbors& neighbors, Time now);
  bool pass_on(const wire::RouteRequest& request, const Neighbors& neighbors, Time now);
  std::optional<MacAddress> only_receiver(const std::vector<MacAddress>& needy, const Neighbors& neighbors,
                                          Time now) const;
  using Holders = std::vector<wire::NeighborTag>;
  static bool ends_at(const wire::RouteRequest& request, const MacAddress& neighbor);
  static bool silent_with_it(const MacAddress& neighbor, const Holders& holders, const Neighbors& neighbors, Time now);
  static Holders holders_of(const Seen& seen, const Neighbors& neighbors);
  static std::vector<MacAddress> in_need(const wire::RouteRequest& request, const Seen& seen,
                                         const Neighbors& neighbors, Time now);
  static double chance_to_miss(const MacAddress& neighbor, const Holders& holders, const Neighbors& neighbors,
                               Time now);

  const Timings& timings_;
  bool hops_acknowledge_;
  Outbox& outbox_;
  Random& random_;
  RequestLoad load_;
  std::unordered_map<Key, Seen, KeyHash> seen_;
  std::deque<std::pair<Time, Key>> order_;  ///< in which they are forgotten
  std::vector<Pending> pending_;
};

}  // namespace adhoc_communication::routing
