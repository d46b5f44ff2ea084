// What kind of radio a Medium is.
#pragma once

#include <cstddef>
#include <optional>

#include "adhoc_communication/types.hpp"
#include "medium/bursts.hpp"
#include "medium/delay.hpp"
#include "medium/interference.hpp"
#include "medium/rates.hpp"
#include "medium/shadowing.hpp"
#include "medium/walls.hpp"
#include "propagation/path_loss.hpp"

namespace adhoc_communication {

struct MediumOptions {
  double range = 10.0;                                  ///< metres; robots farther apart do not hear each other
  double loss = 0.0;                                    ///< probability per frame and receiver
  double bit_rate = 50e6;                               ///< bit/s for the octets behind the Ethernet header
  Time frame_overhead = std::chrono::microseconds(50);  ///< air time of a frame besides its octets
  bool shared = false;             ///< all nodes take turns on one channel; otherwise each has its own to send on
  bool spatial_reuse = false;      ///< with `shared`: frames that disturb each other nowhere share a turn
  std::size_t queue_limit = 1000;  ///< frames of a node waiting for the air; further ones are lost
  double duplication = 0.0;        ///< probability that a frame arrives twice
  double reordering = 0.0;         ///< probability that a frame arrives up to 5 ms late
  double corruption = 0.0;         ///< probability that one octet of a frame is altered

  /// Decides in place of `range` who hears whom. Without it walls and shadowing weaken a radio of that range.
  std::optional<PathLoss> path_loss;
  Walls walls;
  double wall_attenuation = 10.0;  ///< dB for each wall crossed
  ShadowingOptions shadowing;

  /// One channel for all, and nobody hands out turns: carrier sense, half duplex, collisions.
  bool contention = false;
  double capture = 10.0;                     ///< dB by which a frame has to be stronger than another to survive it
  Time slot = std::chrono::microseconds(9);  ///< a node waits a random number of these before it sends
  std::size_t slots = 16;                    ///< fewer than this many

  /// Frames for one robot and frames for everybody differ.
  RateOptions rates;

  // Each adds to what `loss` and distance do.
  BurstOptions bursts;
  DelayOptions delay;
  InterferenceOptions interference;
};

/// The same options. Throws std::invalid_argument with one sentence if they make no radio.
const MediumOptions& validated(const MediumOptions& options);

}  // namespace adhoc_communication
