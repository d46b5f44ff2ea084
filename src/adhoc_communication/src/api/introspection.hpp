// What hosts may look at, for status, diagnostics and tests. Nothing here changes the engine.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "api/event_queue.hpp"
#include "api/sends.hpp"
#include "multicast/group_traffic.hpp"
#include "security/frame_guard.hpp"
#include "transport/broadcast.hpp"
#include "transport/flood.hpp"
#include "transport/stream_receivers.hpp"
#include "transport/streams.hpp"

namespace adhoc_communication {

class Introspection {
 public:
  struct Layers {
    std::size_t max_packet_size;
    const Identity& self;
    const security::FrameGuard& guard;
    const routing::Neighbors& neighbors;
    const routing::LivingRuns& runs;
    const routing::RobotDirectory& directory;
    const routing::Router& router;
    const transport::Hops& hops;
    const transport::Reassembly& reassembly;
    const transport::Streams& streams;
    const transport::StreamReceivers& receivers;
    const transport::BroadcastReceiver& broadcasts;
    const transport::FloodRelay& floods;
    const multicast::Distributor& distributor;
    const multicast::GroupTraffic& groups;
    const Sends& sends;
    const EventQueue& events;
  };

  explicit Introspection(const Layers& layers) : layers_(layers) {}

  std::vector<std::string> neighbors() const;
  std::vector<std::string> robots() const { return layers_.directory.names(); }
  std::vector<RouteState> routes() const;
  std::vector<TreeState> trees() const;
  std::vector<LinkState> links(Time now) const;
  QueueState queues() const;
  std::vector<std::string> groups() const { return layers_.groups.groups(); }
  GroupState group(const std::string& name, Time now) const { return layers_.groups.state(name, now); }
  std::optional<std::string> name_of(const MacAddress& robot) const;
  /// How full everything is that grows with what the air and the host bring.
  std::vector<TableFill> tables() const;

 private:
  Layers layers_;
};

}  // namespace adhoc_communication
