// Frames in: opened, admitted, entered among the neighbours, and handed to the layer that they concern.
#pragma once

#include "air/lost_links.hpp"
#include "api/incoming.hpp"
#include "api/outgoing.hpp"
#include "presence/admission.hpp"
#include "presence/presence.hpp"
#include "security/frame_guard.hpp"

namespace adhoc_communication::air {

class Reception {
 public:
  struct Layers {
    const Identity& self;
    security::FrameGuard& guard;
    Random& random;
    presence::BeaconRhythm& rhythm;
    presence::Admission& admission;
    routing::Neighbors& neighbors;
    routing::LivingRuns& runs;
    routing::RobotDirectory& directory;
    transport::Hops& hops;
    routing::Router& router;
    presence::Presence& presence;
    transport::Streams& streams;
    transport::Forwarder& forwarder;
    LostLinks& links;
    transport::BroadcastReceiver& broadcasts;
    transport::FloodRelay& floods;
    multicast::Distributor& distributor;
    multicast::GroupTraffic& groups;
    Incoming& incoming;
    Outgoing& outgoing;
    Statistics& statistics;
  };

  /// `loss_ratio`: share of the frames with packets, their acknowledgments and receipts that is thrown away.
  Reception(double loss_ratio, const Layers& layers) : loss_ratio_(loss_ratio), layers_(layers) {}

  void receive(const Frame& frame, Time now);

 private:
  bool lost_artificially(wire::FrameType type);
  bool hear(const wire::FrameHeader& header, Time now);
  void dispatch(const wire::FrameHeader& header, wire::Reader body, Time now);
  void on_data(const MacAddress& from, wire::Data data, Time now);
  void on_transport_acknowledgment(const MacAddress& from, wire::TransportAcknowledgment acknowledgment, Time now);
  void on_broadcast_data(const wire::FrameHeader& header, const wire::BroadcastData& data, Time now);
  void on_flood(const wire::Flood& flood, Time now);
  void malformed() { ++layers_.statistics.frames_dropped.malformed; }

  double loss_ratio_;
  Layers layers_;
};

}  // namespace adhoc_communication::air
