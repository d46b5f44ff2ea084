// Frames of others that wait for the repair of their route.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "transport/hop_sender.hpp"

namespace adhoc_communication::transport {

class HeldFrames {
 public:
  static constexpr std::size_t kMostHeld = 512;  ///< further ones are lost

  void add(const MacAddress& destination, HopFrame frame) {
    if (size_ >= kMostHeld) return;
    frames_[destination].push_back(std::move(frame));
    ++size_;
  }
  /// Those to the destinations for which `released` holds, by destination.
  template <typename Predicate>
  std::map<MacAddress, std::vector<HopFrame>> take(Predicate released) {
    std::map<MacAddress, std::vector<HopFrame>> taken;
    for (auto item = frames_.begin(); item != frames_.end();) {
      const auto candidate = item++;
      if (!released(candidate->first)) continue;
      size_ -= candidate->second.size();
      taken.insert(frames_.extract(candidate));
    }
    return taken;
  }
  std::size_t size() const { return size_; }

 private:
  std::map<MacAddress, std::vector<HopFrame>> frames_;
  std::size_t size_ = 0;
};

}  // namespace adhoc_communication::transport
