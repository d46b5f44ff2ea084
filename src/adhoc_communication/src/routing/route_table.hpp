// RFC 3561 sections 2 and 6.2: routes, and the rule by which news replaces them. Where the RFC compares hop counts,
// costs are compared.
#pragma once

#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "address_map.hpp"
#include "adhoc_communication/timings.hpp"
#include "routing/link_cost.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::routing {

/// A way to a robot that life signs have come.
struct ToldWay {
  std::uint8_t hops = 0;  ///< 0: none is known
  Time at{0};
};

struct Route {
  MacAddress destination{};
  wire::BootTag boot = 0;  ///< run of the destination that the number belongs to; 0 unknown
  std::uint32_t sequence = 0;
  bool sequence_valid = false;
  bool valid = false;
  bool repairable = false;  ///< not valid because its next hop was lost here (section 6.12)
  std::uint8_t hops = 0;
  Cost cost = 0;
  Cost link = 0;             ///< of these, what the first hop cost when the route was taken
  Cost asked = 0;            ///< what it cost when a better route was looked for; 0 if none was
  std::uint32_t wasted = 0;  ///< sixteenths of transmissions that frames cost since, beyond another way
  ToldWay asked_for{};       ///< the way that was told of when a better route was looked for
  MacAddress next_hop{};
  Time expires{0};  ///< valid: becomes invalid then; invalid: is deleted then
  std::set<MacAddress> precursors;
};

/// Of the way, those that the next hop leaves.
inline std::uint8_t hops_beyond(const Route& route) {
  return static_cast<std::uint8_t>(std::max<int>(route.hops, 1) - 1);
}

/// What the route costs now that its first hop costs so much. Of the hops beyond nothing new is known.
inline Cost cost_over(const Route& route, Cost link) { return sum(static_cast<Cost>(route.cost - route.link), link); }

/// What a message says about the way to a destination.
struct RouteOffer {
  MacAddress destination{};
  wire::BootTag boot = 0;
  std::optional<std::uint32_t> sequence;
  std::uint8_t hops = 1;
  Cost cost = kPerfectHop;
  MacAddress next_hop{};
  Time expires{0};
  Cost link = kPerfectHop;  ///< of `cost`, that of the hop to `next_hop`
};

/// At most kMostRoutes entries; when full, the one that ends first makes room.
class RouteTable {
 public:
  static constexpr std::size_t kMostRoutes = 1024;
  static constexpr std::size_t kMostPrecursors = 64;

  explicit RouteTable(const Timings& timings) : timings_(timings) {}

  const Route* find(const MacAddress& destination) const;
  /// The valid route, or null.
  const Route* usable(const MacAddress& destination, Time now) const;

  /// Section 6.2: takes the offer when it is newer, as new and cheaper, or revives an entry without losing freshness.
  /// Tells whether the route was created or changed.
  bool update(const RouteOffer& offer);
  /// The destination itself was heard: a route of one hop, which cannot be part of a loop whatever its number. Not over
  /// a link so lossy that a way round may be cheaper, as long as none is known or that is cheaper indeed.
  void heard_directly(const MacAddress& neighbor, wire::BootTag boot, std::optional<std::uint32_t> sequence, Cost cost,
                      Time expires);
  /// Lengthens a valid route's life (section 6.2), never shortens it.
  void extend(const MacAddress& destination, Time until);
  /// Data is due for it: an entry without valid route, and its number with it, is kept for DELETE_PERIOD anew.
  void keep(const MacAddress& destination, Time now);
  void add_precursor(const MacAddress& destination, const MacAddress& precursor);

  /// A frame goes over the first hop of the route, which costs so much now. While that is clearly more than when the
  /// route was taken, or a better one was last looked for, what a way round might save is added up and returned, in
  /// sixteenths of transmissions. So is what a shorter way that is told of might save, once in a while where it was
  /// looked for before.
  std::uint32_t waste(const MacAddress& destination, Cost link, const ToldWay& told);
  /// A better route is looked for.
  void asked(const MacAddress& destination, Cost link, const ToldWay& told);

  /// Section 6.11 case 1: every route over the neighbour becomes invalid, its number grows by one.
  std::vector<Route> break_link(const MacAddress& next_hop, Time now);
  /// Section 6.11 case 3, with the numbers of the route error.
  std::vector<Route> break_destinations(const wire::RouteError& error, const MacAddress& from, Time now);
  /// Section 6.1: a route that ran out becomes invalid with its number raised; old invalid ones are deleted.
  void expire(Time now);

  /// Destinations whose valid route has come, gone or got another next hop since the last call. That a route's time
  /// runs out is not told.
  std::set<MacAddress> take_changed() { return std::exchange(changed_, {}); }

  std::size_t size() const { return routes_.size(); }
  const AddressMap<Route>& routes() const { return routes_; }

 private:
  Route& entry(const MacAddress& destination);
  void invalidate(Route& route, Time now);

  const Timings& timings_;
  AddressMap<Route> routes_;
  std::set<MacAddress> changed_;
};

}  // namespace adhoc_communication::routing
