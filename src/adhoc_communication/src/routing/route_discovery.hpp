// RFC 3561 sections 6.3 and 6.4: when to ask for a destination, how far, and when to give up.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "adhoc_communication/timings.hpp"
#include "random.hpp"
#include "routing/rate_limit.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::routing {

/// A destination by address, or by name alone while its address is unknown (all zero).
struct Target {
  MacAddress address{};
  std::string name;
};

struct DiscoveryFailure {
  Target target;
  Time elapsed{0};
  bool repair = false;
};

/// At most kMostSearches at once; further ones fail at once. Of these, kMostForOthers at most are not for the robot's
/// own packets: repairs, exchanges, and ways to sources of packets, which get half of the requests at most. A request
/// is repeated up to a quarter of its wait late (jitter of RFC 5148): robots that do not hear each other and began to
/// search at the same moment would otherwise repeat in step, and collide each time. When the search is given up does
/// not change by that.
class RouteDiscovery {
 public:
  static constexpr std::size_t kMostSearches = 64;
  static constexpr std::size_t kMostForOthers = kMostSearches / 4;
  static constexpr int kJitterShare = 4;  ///< of the wait: the first part of so many
  static constexpr int kDetour = 2;       ///< hops more than told of
  /// RING_TRAVERSAL_TIMEs for an answer to a directed request: hops repeat it, which a flood does not wait for, and a
  /// flood too many costs more than the wait.
  static constexpr int kDirectedPatience = 3;
  static constexpr int kDoublingsProlonged = 2;                ///< of the wait for a reply
  static constexpr Time kPatience = std::chrono::seconds(10);  ///< with a target that lives, or was there just now

  struct Step {
    Target target;
    std::uint8_t hop_limit;
    bool directed = false;                         ///< by way of those who told of the target
    std::optional<std::uint32_t> newer_than = {};  ///< only a route with a newer number will do
  };

  /// A search that has succeeded or failed.
  struct Ended {
    Target target;
    Time began{0};
    int requests = 0;
    int replies = 0;
    std::uint32_t last_request = 0;  ///< its id
  };

  RouteDiscovery(const EngineOptions& options, Random& random);

  /// Starts a search unless one is running. `last_hops`: length of the route that was lost, 0 if there was none.
  /// `told_hops`: length of a way that is told of, 0 if there is none; the first request goes along it alone, which
  /// costs no flood and is not limited as these are.
  void search(const Target& target, std::uint8_t last_hops, std::uint8_t told_hops, Time now);
  /// The same for what another robot has sent. False, and no failure is kept, unless that can be tried.
  bool search_for_others(const Target& target, std::uint8_t last_hops, std::uint8_t told_hops, Time now);
  /// Section 6.12: one request, a little farther than the destination was. False unless that can be tried.
  bool repair(const MacAddress& destination, int hop_limit, Time now);
  /// For a route of that number, which works: one request for a newer one. It ends without a word if there is none, and
  /// gives way to a search or a repair. False unless that can be tried.
  bool exchange(const MacAddress& destination, std::uint32_t sequence, int hop_limit, Time now);
  /// `found(target, newer_than)`: there is a route, with a newer number if one is given.
  template <typename Predicate>
  void finish_if(Predicate found);

  /// The requests due now; failures are kept for take_failures(). `told_hops`: as for search(), for a target that was
  /// not found: while there is a way that is told of, the target lives, and is asked for along it up to kPatience.
  /// While the target still counts as `present`, the last request is repeated for own packets, in turn with those: it
  /// may be a fade that hides the target, or the way that is told of may end at a link too bad to carry life signs.
  std::vector<Step> poll(
      const std::function<std::uint8_t(const Target&)>& told_hops, Time now,
      const std::function<bool(const Target&)>& present = [](const Target&) { return false; });
  std::vector<DiscoveryFailure> take_failures() { return std::exchange(failures_, {}); }
  /// What became of a step, for the account of its search.
  void requested(const Target& target, std::uint32_t id);
  void replied(const Target& target);
  std::vector<Ended> take_ended() { return std::exchange(ended_, {}); }
  Time next_deadline() const;
  std::size_t searches() const { return searches_.size(); }
  std::size_t searches_for_others() const;
  /// An exchange is none: there is a route.
  bool searching(const Target& target) const {
    const auto found = searches_.find(key(target));
    return found != searches_.end() && !found->second.newer_than;
  }

 private:
  struct Search {
    Target target;
    Time started{0};
    Time due{0};
    int hop_limit = 0;
    int tries = 0;  ///< at this hop limit
    bool repair = false;
    bool for_others = false;
    bool prolonged = false;                        ///< all tries are used up, and the target is present
    std::uint8_t told_hops = 0;                    ///< of the way to be tried first
    bool was_directed = false;                     ///< the latest request, after the tries
    std::optional<std::uint32_t> newer_than = {};  ///< an exchange, of a route with that number
    int requests = 0;
    int replies = 0;
    std::uint32_t last_request = 0;
    Time late{0};  ///< the next try, by chance
  };
  using Key = std::pair<MacAddress, std::string>;

  static Key key(const Target& target);
  void end(const Search& search) {
    ended_.push_back({search.target, search.started, search.requests, search.replies, search.last_request});
  }
  void begin(const Target& target, std::uint8_t last_hops, std::uint8_t told_hops, bool for_others, Time now);
  bool has_room_for_others() const;
  /// A repair or an exchange is one request.
  static bool half_of_limit(const Search& search) { return search.for_others && !search.repair && !search.newer_than; }
  /// When a request of it may go.
  Time free_at(const Search& search, Time now) const;
  bool take(const Search& search, Time now);
  bool once(const MacAddress& destination, int hop_limit, std::optional<std::uint32_t> newer_than, Time now);
  void end_exchange(const Target& target);
  bool advance(Search& search, Time now);
  Step directed(Search& search, Time now) const;
  int next_ring(int hop_limit) const;
  bool is_last_ring(int hop_limit) const { return hop_limit >= last_ring_; }

  const Timings& timings_;
  Random& random_;
  int first_ring_;
  int last_ring_;
  int increment_;
  int tries_per_ring_;
  RateLimit rate_limit_;
  RateLimit others_limit_;
  std::map<Key, Search> searches_;
  std::vector<DiscoveryFailure> failures_;
  std::vector<Ended> ended_;
};

template <typename Predicate>
void RouteDiscovery::finish_if(Predicate found) {
  for (auto iterator = searches_.begin(); iterator != searches_.end();) {
    const bool ends = found(iterator->second.target, iterator->second.newer_than);
    if (ends) end(iterator->second);
    iterator = ends ? searches_.erase(iterator) : std::next(iterator);
  }
}

}  // namespace adhoc_communication::routing
