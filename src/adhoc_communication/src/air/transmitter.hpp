// Frames on their way to the radio: numbered, sealed, counted.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "air/air_clock.hpp"
#include "identity.hpp"
#include "presence/beacon_rhythm.hpp"
#include "security/frame_guard.hpp"

namespace adhoc_communication::air {

class Transmitter {
 public:
  Transmitter(const Identity& self, const security::FrameGuard& guard, AirClock& air, presence::BeaconRhythm& rhythm,
              Statistics& statistics)
      : self_(self), guard_(guard), air_(air), rhythm_(rhythm), statistics_(statistics) {}

  /// Of the next frame. Counters only grow.
  std::uint64_t next_counter() const { return next_counter_; }
  std::uint64_t take_counter() { return next_counter_++; }

  /// What a frame says of itself besides its type.
  struct Labels {
    std::uint8_t flags = 0;
    std::uint32_t link_sequence = 0;
    std::uint64_t counter = 0;
    std::uint8_t priority = static_cast<std::uint8_t>(Priority::kControl);
  };
  /// `next_hop`: a neighbour, or wire::kEverybody.
  void transmit(wire::FrameType type, const MacAddress& next_hop, const Labels& labels, const Bytes& body, Time now);
  /// With the next counter, and without an acknowledgment.
  void transmit(wire::FrameType type, const MacAddress& next_hop, const Bytes& body, Time now) {
    transmit(type, next_hop, {0, 0, take_counter()}, body, now);
  }
  /// Those of the present call of the host, in order.
  std::vector<Frame> take_frames() { return std::exchange(frames_, {}); }

 private:
  const Identity& self_;
  const security::FrameGuard& guard_;
  AirClock& air_;
  presence::BeaconRhythm& rhythm_;
  Statistics& statistics_;
  std::uint64_t next_counter_ = 1;
  std::vector<Frame> frames_;
};

}  // namespace adhoc_communication::air
