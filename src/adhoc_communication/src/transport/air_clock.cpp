#include "transport/air_clock.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

void AirClock::transmitted(std::uint64_t counter, std::size_t octets, Time now) {
  if (on_air_.size() == kMostRemembered) on_air_.pop_front();
  on_air_.push_back({counter, octets + kOverheadOctets, now});
  busy_until_ = std::max(busy_until_, now) + air_time(octets + kOverheadOctets);
}

void AirClock::acknowledged(std::uint64_t counter, Time now) {
  std::size_t passed = 0;
  bool back_to_back = last_acknowledged_.has_value();
  bool any = false;
  while (!on_air_.empty() && on_air_.front().counter <= counter) {
    passed += on_air_.front().octets;
    // A frame handed over after the last acknowledgment may have found the radio idle.
    back_to_back = back_to_back && on_air_.front().sent <= *last_acknowledged_;
    any = true;
    on_air_.pop_front();
  }
  if (!any) return;
  if (back_to_back) sample(passed, now - *last_acknowledged_);
  last_acknowledged_ = now;
  std::size_t left = 0;
  for (const Transmission& transmission : on_air_) left += transmission.octets;
  busy_until_ = std::min(busy_until_, now + air_time(left));
}

void AirClock::sample(std::size_t octets, Time duration) {
  constexpr double kGain = 0.125;
  const double measured = static_cast<double>(duration.count()) / static_cast<double>(octets);
  const double bounded = std::clamp(measured, nanoseconds_per_octet_ / 4, nanoseconds_per_octet_ * 4);
  nanoseconds_per_octet_ += kGain * (bounded - nanoseconds_per_octet_);
  nanoseconds_per_octet_ = std::clamp(nanoseconds_per_octet_, 1.0, 100'000.0);
  ++samples_;
}

}  // namespace adhoc_communication::transport
