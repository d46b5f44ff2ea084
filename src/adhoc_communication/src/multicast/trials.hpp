// How often a few frames go to each child by itself to learn what that costs: ever more rarely.
#pragma once

#include <algorithm>

namespace adhoc_communication::multicast {

class Trials {
 public:
  static constexpr int kInterval = 8;  ///< frames between two trials, at first; then twice as many, and so on
  static constexpr int kLongestInterval = 1024;

  bool due() const { return frames_ >= interval_; }
  void sent() { ++frames_; }
  void begun() {
    frames_ = 0;
    interval_ = std::min(2 * interval_, kLongestInterval);
  }

 private:
  int interval_ = kInterval / 2;
  int frames_ = kInterval;  ///< since the last trial; the first one is due at once
};

}  // namespace adhoc_communication::multicast
