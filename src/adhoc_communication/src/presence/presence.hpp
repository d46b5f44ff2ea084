// How a robot tells the others that it is there, and learns who is.
#pragma once

#include "presence/beacon_rhythm.hpp"
#include "routing/router.hpp"
#include "transport/hops.hpp"

namespace adhoc_communication::presence {

class Presence {
 public:
  Presence(const Identity& self, const EngineOptions& options, routing::Neighbors& neighbors, routing::LivingRuns& runs,
           routing::RobotDirectory& directory, routing::Router& router, BeaconRhythm& rhythm, transport::Hops& hops,
           Time now)
      : self_(self),
        options_(options),
        neighbors_(neighbors),
        runs_(runs),
        directory_(directory),
        router_(router),
        rhythm_(rhythm),
        hops_(hops),
        started_(now) {}

  void send_beacon(Time now);
  void on_beacon(const MacAddress& from, wire::BootTag boot, const wire::Beacon& beacon, Time now);
  /// Asks neighbours that have become quiet for an acknowledgment: a few beacons may just have been lost.
  void probe_doubtful(Time now);
  /// The same of one neighbour, unless frames to it await an answer already.
  void ask(const MacAddress& neighbor, Time now);
  /// Where another run may live at the neighbour's address than the one that is known.
  void ask_in_doubt(const MacAddress& neighbor, Time now);

 private:
  wire::Beacon plain_beacon(Time now) const;

  const Identity& self_;
  const EngineOptions& options_;
  routing::Neighbors& neighbors_;
  routing::LivingRuns& runs_;
  routing::RobotDirectory& directory_;
  routing::Router& router_;
  BeaconRhythm& rhythm_;
  transport::Hops& hops_;
  Time started_;
  std::uint16_t beacons_sent_ = 0;
};

}  // namespace adhoc_communication::presence
