// Whether others send on the channel that this robot's frames go out on.
#pragma once

#include <algorithm>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::air {

/// Known for a while when frames were seen to wait for those of others. Robots that take turns for it do not wait for
/// each other any more, so it is remembered longer each time that it turns out to be so still.
class SharedAir {
 public:
  static constexpr Time kShortestMemory = std::chrono::seconds(10);
  static constexpr Time kLongestMemory = std::chrono::seconds(600);

  void waited(Time now) {
    if (now < until_) return;
    memory_ = memory_ == Time(0) ? kShortestMemory : std::min(4 * memory_, kLongestMemory);
    until_ = now + memory_;
  }
  bool shared(Time now) const { return now < until_; }

 private:
  Time memory_{0};
  Time until_{0};
};

}  // namespace adhoc_communication::air
