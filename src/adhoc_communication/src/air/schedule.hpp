// What goes on the air next: the most urgent frame first, no more than the air can take.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "air/fair_share.hpp"
#include "multicast/distributor.hpp"
#include "transport/broadcast.hpp"
#include "transport/streams.hpp"

namespace adhoc_communication::air {

/// Of one priority: frames of the robot that has sent the fewest octets (this one among them), repetitions included, so
/// that a hop which loses much costs those whose frames it carries; of its frames those of groups and the others
/// likewise.
class Schedule {
 public:
  Schedule(const AirClock& air, Transmitter& transmitter, transport::Hops& hops, transport::Streams& streams,
           transport::BroadcastSenders& broadcasts, multicast::Distributor& distributor, Statistics& statistics)
      : air_(air),
        transmitter_(transmitter),
        hops_(hops),
        streams_(streams),
        broadcasts_(broadcasts),
        distributor_(distributor),
        statistics_(statistics) {}

  /// Sends as much as may be sent. Returns the broadcasts that are now out as a whole.
  std::vector<SendId> pump(Time now);
  /// When to pump again; Time::max() if nothing waits for the air.
  Time next_deadline(Time now) const;

 private:
  bool send_one(Time now);
  bool send_one(std::uint8_t priority, Time now);
  std::vector<MacAddress> waiting_hops(std::uint8_t priority) const;
  bool send_from(const MacAddress& previous_hop, std::uint8_t priority, Time now);
  bool send_packet_frame(const MacAddress& previous_hop, std::uint8_t priority, Time now);
  bool send_broadcast(std::uint8_t priority, Time now);
  bool send_group_frame(const MacAddress& previous_hop, std::uint8_t priority, Time now);
  bool something_waits(Time now) const;

  const AirClock& air_;
  Transmitter& transmitter_;
  transport::Hops& hops_;
  transport::Streams& streams_;
  transport::BroadcastSenders& broadcasts_;
  multicast::Distributor& distributor_;
  Statistics& statistics_;
  /// Between the robots that frames come from, this one (all zero) among them.
  std::array<air::FairShare<MacAddress>, transport::kPriorities> shares_;
  /// For each of them, between frames of groups and others.
  std::array<air::FairShare<std::pair<MacAddress, bool>>, transport::kPriorities> group_shares_;
  std::uint64_t last_group_counter_ = 0;
  MacAddress last_group_destination_ = wire::kEverybody;
  int group_pair_ = 0;  ///< counts frames of groups to that destination; 0 and 1 are a pair
  std::vector<SendId> finished_;
};

}  // namespace adhoc_communication::air
