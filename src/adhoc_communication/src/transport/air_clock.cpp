#include "transport/air_clock.hpp"

#include <algorithm>

namespace adhoc_communication::transport {
namespace {

constexpr double kGain = 0.125;  ///< of a measurement

}  // namespace

void AirClock::transmitted(std::uint64_t counter, std::size_t octets, Time now) {
  if (on_air_.size() == kMostRemembered) on_air_.pop_front();
  on_air_.push_back({counter, octets + kOverheadOctets, now});
  busy_until_ = std::max(busy_until_, now) + air_time(octets + kOverheadOctets);
}

void AirClock::acknowledged(std::uint64_t counter, Time spacing, Time arrived) {
  if (!take(counter, spacing)) return;
  if (before_.counter == counter) bound(before_.octets, arrived - before_.sent);
  busy_until_ = end_of_rest(arrived);
}

void AirClock::acknowledged_late(std::uint64_t counter, Time spacing, Time now) {
  if (take(counter, spacing)) busy_until_ = std::min(busy_until_, end_of_rest(now));
}

/// Removes what is off the air; false if that was known.
bool AirClock::take(std::uint64_t counter, Time spacing) {
  if (on_air_.empty() || on_air_.front().counter > counter) return false;
  while (!on_air_.empty() && on_air_.front().counter <= counter) {
    const Transmission transmission = on_air_.front();
    on_air_.pop_front();
    // A frame handed over as late as it arrived after the one before may have found the radio idle.
    const bool follows = transmission.counter == before_.counter + 1;
    const bool together = follows && transmission.sent - before_.sent < spacing * 4 / 5;
    if (transmission.counter == counter && together) sample(transmission.octets, spacing);
    before_ = transmission;
  }
  return true;
}

/// A frame was not longer on the air than from the hand-over to its arrival. A relay that passes on each frame as it
/// comes never has two in the radio, and learns from nothing else; and on a shared channel, pairs alone would tell too
/// late that the others have fallen silent.
void AirClock::bound(std::size_t octets, Time longest) {
  const double most = std::max(1.0, static_cast<double>(longest.count()) / static_cast<double>(octets));
  const double excess = std::max(0.0, nanoseconds_per_octet_ - most);
  nanoseconds_per_octet_ -= samples_ < kEnoughSamples ? excess : excess * kGain;
  bounds_ = std::min(bounds_ + 1, kEnoughBounds);
}

/// Each frame follows the one before as soon as it is there.
Time AirClock::end_of_rest(Time begin) const {
  Time end = begin;
  for (const Transmission& transmission : on_air_) {
    end = std::max(end, transmission.sent) + air_time(transmission.octets);
  }
  return end;
}

void AirClock::sample(std::size_t octets, Time duration) {
  const double measured = static_cast<double>(duration.count()) / static_cast<double>(octets);
  const double bounded = std::clamp(measured, nanoseconds_per_octet_ / 16, nanoseconds_per_octet_ * 16);
  const double gain = std::max(kGain, 1.0 / (samples_ + 1));
  nanoseconds_per_octet_ += gain * (bounded - nanoseconds_per_octet_);
  nanoseconds_per_octet_ = std::clamp(nanoseconds_per_octet_, 1.0, 100'000.0);
  samples_ = std::min(samples_ + 1, kEnoughSamples);
}

}  // namespace adhoc_communication::transport
