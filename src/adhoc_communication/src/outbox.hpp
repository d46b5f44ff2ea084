// How a layer hands a message to the one below.
#pragma once

#include "wire/frame_header.hpp"

namespace adhoc_communication {

class Outbox {
 public:
  virtual ~Outbox() = default;
  /// To everybody in range, once, unacknowledged.
  virtual void broadcast(wire::FrameType type, Bytes body, Time now) = 0;
  /// To a neighbour, once, unacknowledged.
  virtual void unicast_once(const MacAddress& neighbor, wire::FrameType type, Bytes body, Time now) = 0;
  /// To a neighbour, repeated until acknowledged, ahead of all packets.
  virtual void unicast(const MacAddress& neighbor, wire::FrameType type, Bytes body) = 0;
  /// When the radio will have room for a further frame.
  virtual Time air_ready() const { return Time(0); }
};

}  // namespace adhoc_communication
