// Packets put together: for the host, or about groups.
#pragma once

#include <string>

#include "api/event_queue.hpp"
#include "api/outgoing.hpp"
#include "multicast/distributor.hpp"
#include "multicast/group_traffic.hpp"
#include "routing/router.hpp"
#include "transport/broadcast.hpp"
#include "transport/stream_receivers.hpp"

namespace adhoc_communication {

class Incoming {
 public:
  enum class Carrier { kStream, kBroadcast, kFlood, kGroup };

  /// Where packets come from.
  struct Carriers {
    transport::StreamReceivers& receivers;
    transport::BroadcastReceiver& broadcasts;
    multicast::Distributor& distributor;
    multicast::GroupTraffic& groups;
    transport::Reassembly& reassembly;
  };

  Incoming(std::size_t max_packet_size, const routing::RobotDirectory& directory, routing::Router& router,
           const Carriers& carriers, Outgoing& outgoing, EventQueue& events, Statistics& statistics)
      : max_packet_size_(max_packet_size),
        directory_(directory),
        router_(router),
        receivers_(carriers.receivers),
        broadcasts_(carriers.broadcasts),
        distributor_(carriers.distributor),
        groups_(carriers.groups),
        reassembly_(carriers.reassembly),
        outgoing_(outgoing),
        events_(events),
        statistics_(statistics) {}

  /// A segment for this robot.
  void take(const wire::Data& data, Time now);
  /// A whole packet: from its image to an event, or to the groups that it is about.
  void deliver(Carrier carrier, const std::string& source, wire::BootTag boot, Bytes image, std::uint8_t hops,
               Time now);
  /// What the distributor has put together.
  void take_group_packets(Time now);
  void forget_evicted(Time now);

 private:
  bool admits(Carrier carrier, const std::string& source, const transport::Packet& packet) const;
  void malformed() { ++statistics_.frames_dropped.malformed; }

  std::size_t max_packet_size_;
  const routing::RobotDirectory& directory_;
  routing::Router& router_;
  transport::StreamReceivers& receivers_;
  transport::BroadcastReceiver& broadcasts_;
  multicast::Distributor& distributor_;
  multicast::GroupTraffic& groups_;
  transport::Reassembly& reassembly_;
  Outgoing& outgoing_;
  EventQueue& events_;
  Statistics& statistics_;
};

}  // namespace adhoc_communication
