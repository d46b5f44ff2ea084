// RFC 3561 for link-layer addresses and robot names: finds, keeps and repairs routes.
#pragma once

#include <deque>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "api/journal.hpp"
#include "identity.hpp"
#include "outbox.hpp"
#include "random.hpp"
#include "routing/neighbors.hpp"
#include "routing/rate_limit.hpp"
#include "routing/repairs.hpp"
#include "routing/request_flood.hpp"
#include "routing/robot_directory.hpp"
#include "routing/route_discovery.hpp"
#include "routing/route_table.hpp"

namespace adhoc_communication::routing {

class Router {
 public:
  Router(const Identity& self, const EngineOptions& options, Neighbors& neighbors, LivingRuns& runs,
         RobotDirectory& directory, Outbox& outbox, Random& random, Journal& journal, Time now);

  std::uint32_t own_sequence() const { return own_sequence_; }
  const RouteTable& table() const { return routes_; }
  const RequestLoad& request_load() const { return flood_.load(); }
  std::size_t searches() const { return discovery_.searches(); }
  std::size_t searches_for_others() const { return discovery_.searches_for_others(); }
  std::size_t requests_remembered() const { return flood_.remembered(); }
  const Route* route_to(const MacAddress& destination, Time now) const { return routes_.usable(destination, now); }
  std::set<MacAddress> take_changed_routes() { return routes_.take_changed(); }
  RouteEnds ends_to(const MacAddress& destination, Time now) const;

  /// Section 6.3: data is due and there is no route.
  void search(const Target& target, Time now);
  /// A way to another robot is wanted for what it, or somebody in its name, has sent. False if that cannot be tried.
  bool search_for_others(const Target& target, Time now);
  /// One request of small reach, as for a repair: for a way that only has to lead round somebody. False if that cannot
  /// be tried now.
  bool search_nearby(const MacAddress& destination, Time now);
  bool searching(const Target& target) const { return discovery_.searching(target); }
  /// Searches that failed; of repairs, the precursors have been told already.
  std::vector<DiscoveryFailure> take_failures(Time now);

  /// A beacon of a neighbour whose link works both ways (section 6.9).
  void on_hello(const MacAddress& from, std::uint32_t sequence, Time now);
  void on_request(const MacAddress& from, wire::RouteRequest request, Time now);
  void on_reply(const MacAddress& from, wire::RouteReply reply, Time now);
  void on_error(const MacAddress& from, const wire::RouteError& error, Time now);
  void on_reply_acknowledgment(const MacAddress& from, Time now);

  /// Section 6.2: data between two robots passed through here.
  void used(const MacAddress& source, const MacAddress& destination, const MacAddress& previous_hop, Time now);
  /// Section 6.11 case 1. Routes with data in hand are repaired where that is possible.
  void link_broken(const MacAddress& neighbor, const DataInHand& in_hand, Time now);
  /// The data may wait for the route.
  bool repairing(const MacAddress& destination) const { return repairs_.count(destination) != 0; }
  /// Data came for a route that broke before: section 6.12 repairs it then.
  bool repair_late(const MacAddress& destination, const MacAddress& originator, const MacAddress& previous_hop,
                   Time now);
  /// Section 6.8: the neighbour did not acknowledge a reply.
  void reply_lost(const MacAddress& neighbor, Time now) { neighbors_.blacklist(neighbor, now); }
  /// Section 6.11 case 2: data from `previous_hop` cannot go on.
  void no_route_for(const MacAddress& destination, const MacAddress& previous_hop, Time now);

  void poll(Time now);
  Time next_deadline() const;
  /// Ages routes; to be called a few times a second.
  void expire(Time now) { routes_.expire(now); }

 private:
  bool is_destination(const wire::RouteRequest& request) const;
  MacAddress address_asked(const wire::RouteRequest& request) const;
  void send_request(const RouteDiscovery::Step& step, Time now);
  void answer_as_destination(const wire::RouteRequest& request, const MacAddress& to, bool first, Time now);
  bool answer_from_table(const wire::RouteRequest& request, const MacAddress& to, Time now);
  void answer_gratuitously(const wire::RouteRequest& request, const Route& to_destination, Time now);
  void forward_request(wire::RouteRequest request, const MacAddress& from, Time now);
  std::uint8_t last_hops(const Target& target) const;
  std::uint8_t hops_told(const Target& target, Time now) const;
  MacAddress address_of(const Target& target) const;
  std::optional<MacAddress> way_told(const MacAddress& destination, Time now) const;
  void look_for_better(const Route& route, bool is_source, Time now);
  ToldWay told_way(const MacAddress& destination, Time now) const;
  bool better_one_known(const wire::RouteReply& reply, Time now) const;
  bool worth_forwarding(const wire::RouteReply& reply, bool updated, const MacAddress& from, Time now);
  void forward_reply(wire::RouteReply reply, Time now);
  void announce_broken(const std::vector<Route>& broken, const MacAddress& except, bool unknown_sequence, Time now);
  void finish_searches(Time now);
  void record_searches(Time now);
  void record_arrival(const wire::RouteRequest& request, const MacAddress& from, bool answered, Time now);
  void hear_directly(const MacAddress& neighbor, std::optional<std::uint32_t> sequence, Time now);
  void send_reply(const MacAddress& to, wire::RouteReply reply, Time now);
  void repeat_replies(Time now);
  void pass_on_repaired(const MacAddress& from, const wire::RouteError& error, Time now);
  bool start_repair(const Route& broken, const MacAddress& originator, Time now);
  void repair_succeeded(const MacAddress& destination, Repair repair, Time now);
  void announce_failed_repair(const MacAddress& destination, Time now);
  void send_error(const wire::RouteError& error, std::set<MacAddress> concerned, Time now);
  void send_waiting_errors(Time now);

  const Identity& self_;
  const Timings& timings_;
  Neighbors& neighbors_;
  LivingRuns& runs_;
  RobotDirectory& directory_;
  Outbox& outbox_;
  Journal& journal_;
  RouteTable routes_;
  RouteDiscovery discovery_;
  RequestFlood flood_;
  RateLimit error_limit_;
  /// Lost routes that the rate limit does not let announce yet.
  struct WaitingError {
    wire::RouteError error;
    std::set<MacAddress> concerned;
  };
  std::deque<WaitingError> waiting_errors_;
  Repairs repairs_;
  bool hops_acknowledge_;
  /// A reply whose RREP-ACK has not come.
  struct OpenReply {
    wire::RouteReply reply;
    Time due;
    int tries;
  };
  std::map<MacAddress, OpenReply> open_replies_;  ///< the latest to each neighbour
  Time started_;
  std::uint32_t own_sequence_ = 0;
  std::uint32_t next_request_id_ = 0;
  struct Forwarded {
    std::uint32_t sequence;
    Time at;
  };
  std::map<std::pair<MacAddress, MacAddress>, Forwarded> forwarded_replies_;  ///< by originator and destination
};

}  // namespace adhoc_communication::routing
