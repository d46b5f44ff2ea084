#include "air/air_rate.hpp"

#include <algorithm>
#include <cmath>

namespace adhoc_communication::air {
namespace {

constexpr double kGain = 0.125;  ///< of a measurement
constexpr double kArrivalGain = 1.0 / 32.0;
/// With each measurement, so that a radio that got slower is believed.
constexpr double kLeastGrowth = 1.0 + 1.0 / 256.0;

}  // namespace

void AirRate::arrived(bool together) {
  together_ += kArrivalGain * ((together ? 1.0 : 0.0) - together_);
  jittered_ = together_ >= (jittered_ ? kJitterEnds : kJitterBegins);
  if (jittered_) nanoseconds_per_octet_ = std::min(nanoseconds_per_octet_, least_);
}

void AirRate::sample(std::size_t octets, Time duration, Time now) {
  const double measured = static_cast<double>(duration.count()) / static_cast<double>(octets + kOverheadOctets);
  const double bounded = std::clamp(measured, nanoseconds_per_octet_ / 16, nanoseconds_per_octet_ * 16);
  // Of the first ones, those that others have disturbed are not waited for to be outweighed.
  const bool undisturbed = samples_ < kEnoughSamples && bounded < nanoseconds_per_octet_;
  const double gain = undisturbed ? 1.0 : std::max(kGain, 1.0 / (samples_ + 1));
  if (samples_ >= kEnoughSamples) deviation_ += kGain * (std::abs(bounded - nanoseconds_per_octet_) - deviation_);
  nanoseconds_per_octet_ += gain * (bounded - nanoseconds_per_octet_);
  least_ = std::min(measured, kLeastGrowth * least_);
  if (jittered_) nanoseconds_per_octet_ = least_;
  nanoseconds_per_octet_ = std::clamp(nanoseconds_per_octet_, 1.0, 100'000.0);
  samples_ = std::min(samples_ + 1, kEnoughSamples);
  latest_[taken_++ % latest_.size()] = measured;
  measured_ = now;
}

/// A relay that passes on each frame as it comes never has two in the radio, and learns from nothing else; and on a
/// shared channel, pairs alone would tell too late that the others have fallen silent.
void AirRate::bound(std::size_t octets, Time longest) {
  const auto all_octets = static_cast<double>(octets + kOverheadOctets);
  const double most = std::max(1.0, static_cast<double>(longest.count()) / all_octets);
  const double excess = std::max(0.0, nanoseconds_per_octet_ - most);
  nanoseconds_per_octet_ -= samples_ < kEnoughSamples ? excess : excess * kGain;
  bounds_ = std::min(bounds_ + 1, kEnoughBounds);
}

}  // namespace adhoc_communication::air
