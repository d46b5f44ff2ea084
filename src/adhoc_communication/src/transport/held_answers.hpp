// Whether a neighbour holds its answers back until what they are about is with the next robot.
#pragma once

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

/// Counts answers that were asked for at once.
class HeldAnswers {
 public:
  static constexpr int kHeldFrames = 2;    ///< air times of a frame, longer than which none waits for the radio alone
  static constexpr double kHolds = 0.375;  ///< share of who holds them: one of three may be about the last frame

  void count(Time held, Time frame_time) { share_ += ((held > kHeldFrames * frame_time ? 1.0 : 0.0) - share_) / 2; }
  bool usual() const { return share_ > kHolds; }

 private:
  double share_ = 0.0;  ///< of the latest ones
};

}  // namespace adhoc_communication::transport
