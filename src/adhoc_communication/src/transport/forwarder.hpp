// Frames that travel further than to the next robot: passed on, and held while their route is repaired.
#pragma once

#include "routing/router.hpp"
#include "transport/held_frames.hpp"
#include "transport/hops.hpp"

namespace adhoc_communication::transport {

class Forwarder {
 public:
  Forwarder(const Identity& self, routing::Router& router, Hops& hops) : self_(self), router_(router), hops_(hops) {}

  void forward(const MacAddress& from, wire::Data data, Time now);
  void forward(const MacAddress& from, wire::TransportAcknowledgment acknowledgment, Time now);
  /// What was under way to the neighbour waits for the repair of its route, or is left to the repetition from end to
  /// end.
  void link_lost(const MacAddress& neighbor, Time now);
  /// Frames whose repair has ended go on, or are dropped.
  void release(Time now);

 private:
  template <typename Message>
  void pass_on(const MacAddress& from, Message message, wire::FrameType type, std::uint8_t priority, Time now);

  const Identity& self_;
  routing::Router& router_;
  Hops& hops_;
  HeldFrames held_;
};

}  // namespace adhoc_communication::transport
