// Whether route requests come so often that their copies would leave no air for anything else. In a large team every
// robot hears each request from all around it.
#pragma once

#include <deque>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::routing {

class RequestLoad {
 public:
  static constexpr std::size_t kHeavy = 200;  ///< requests heard in kWindow, copies included
  static constexpr Time kWindow = std::chrono::seconds(1);

  void heard(Time now) {
    if (latest_.size() == kHeavy) latest_.pop_front();
    latest_.push_back(now);
  }
  bool heavy(Time now) const { return latest_.size() == kHeavy && now - latest_.front() < kWindow; }

 private:
  std::deque<Time> latest_;
};

}  // namespace adhoc_communication::routing
