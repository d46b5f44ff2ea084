// RREQ_RATELIMIT and RERR_RATELIMIT (RFC 3561 sections 6.3 and 6.11): so many in any window of one second. Frames wait
// a few milliseconds for the air, so the window is a little longer.
#pragma once

#include <deque>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::routing {

class RateLimit {
 public:
  explicit RateLimit(int per_second) : per_second_(static_cast<std::size_t>(per_second)) {}

  /// When the next one may go.
  Time free_at(Time now) const { return recent_.size() < per_second_ ? now : std::max(now, recent_.front() + kWindow); }
  bool take(Time now) {
    if (free_at(now) > now) return false;
    if (recent_.size() == per_second_) recent_.pop_front();
    recent_.push_back(now);
    return true;
  }

 private:
  static constexpr Time kWindow = std::chrono::milliseconds(1050);

  std::size_t per_second_;
  std::deque<Time> recent_;
};

}  // namespace adhoc_communication::routing
