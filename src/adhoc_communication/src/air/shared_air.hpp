// Whether others send on the channel that this robot's frames go out on.
#pragma once

#include <algorithm>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::air {

/// Known for a while when frames were seen to wait for those of others. Robots that take turns for it do not wait for
/// each other any more, so it is remembered longer each time that it turns out to be so still. Frames also come late
/// where a computer is busy; only those that the device had to keep can have waited for the air.
class SharedAir {
 public:
  static constexpr int kKept = 4;  ///< measured frames in a row: as many as the least spacing is taken of
  static constexpr Time kShortestMemory = std::chrono::seconds(10);
  static constexpr Time kLongestMemory = std::chrono::seconds(600);

  /// Of a frame to a neighbour. `apart`: such frames arrive further apart than where nobody else sends; `kept`: the
  /// device did not send it as soon as it had it.
  void measured(bool apart, bool kept, Time now) {
    kept_ = kept ? std::min(kept_ + 1, kKept) : 0;
    if (!apart || kept_ < kKept || now < until_) return;
    memory_ = memory_ == Time(0) ? kShortestMemory : std::min(4 * memory_, kLongestMemory);
    until_ = now + memory_;
  }
  /// What made frames seem to wait turned out to be something else.
  void disproved() { *this = {}; }
  bool shared(Time now) const { return now < until_; }
  /// Remembered, or only just forgotten: it may well turn out to be so again.
  bool perhaps_shared(Time now) const { return now < until_ + memory_; }

 private:
  int kept_ = 0;
  Time memory_{0};
  Time until_{0};
};

}  // namespace adhoc_communication::air
