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
  believe();
}

void AirRate::believe() {
  jittered_ = mean_ > kStretched && together_ >= (jittered_ ? kJitterEnds : kJitterBegins);
  nanoseconds_per_octet_ = jittered_ ? std::min(mean_, least_) : mean_;
}

void AirRate::sample(std::size_t octets, Time duration, Time now) {
  const double measured = static_cast<double>(duration.count()) / static_cast<double>(octets + kOverheadOctets);
  const double bounded = std::clamp(measured, mean_ / 16, mean_ * 16);
  // Of the first ones, those that others have disturbed are not waited for to be outweighed.
  const bool undisturbed = samples_ < kEnoughSamples && bounded < mean_;
  const double gain = undisturbed ? 1.0 : std::max(kGain, 1.0 / (samples_ + 1));
  if (samples_ >= kEnoughSamples) deviation_ += kGain * (std::abs(bounded - mean_) - deviation_);
  mean_ = std::clamp(mean_ + gain * (bounded - mean_), 1.0, 100'000.0);
  if (measured > kFastest) least_ = std::min(measured, kLeastGrowth * least_);
  believe();
  samples_ = std::min(samples_ + 1, kEnoughSamples);
  latest_[taken_++ % latest_.size()] = measured;
  measured_ = now;
}

/// A relay that passes on each frame as it comes never has two in the radio, and learns from nothing else; and on a
/// shared channel, pairs alone would tell too late that the others have fallen silent.
void AirRate::bound(std::size_t octets, Time longest) {
  const auto all_octets = static_cast<double>(octets + kOverheadOctets);
  const double most = std::max(1.0, static_cast<double>(longest.count()) / all_octets);
  const double excess = std::max(0.0, mean_ - most);
  mean_ -= samples_ < kEnoughSamples ? excess : excess * kGain;
  believe();
  bounds_ = std::min(bounds_ + 1, kEnoughBounds);
}

}  // namespace adhoc_communication::air
