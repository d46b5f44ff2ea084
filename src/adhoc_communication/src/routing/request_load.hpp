// Whether route requests come so often that their copies would leave no air for anything else. In a large team every
// robot hears each request from all around it.
#pragma once

#include <deque>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::routing {

class RequestLoad {
 public:
  static constexpr std::size_t kHeavy = 200;  ///< requests heard in kWindow, copies included
  static constexpr std::size_t kFull = 400;
  static constexpr Time kWindow = std::chrono::seconds(1);

  void heard(Time now) {
    if (latest_.size() == kFull) latest_.pop_front();
    latest_.push_back(now);
  }
  bool heavy(Time now) const { return has_heard(kHeavy, now); }
  /// So many that whoever need not join a group now does not.
  bool full(Time now) const { return has_heard(kFull, now); }

 private:
  bool has_heard(std::size_t requests, Time now) const {
    return latest_.size() >= requests && now - latest_[latest_.size() - requests] < kWindow;
  }

  std::deque<Time> latest_;
};

}  // namespace adhoc_communication::routing
