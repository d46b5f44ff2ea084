// Log-normal shadowing that is the same both ways and changes little over short distances.
#pragma once

#include <cstdint>

#include "propagation/position.hpp"

namespace adhoc_communication {

struct ShadowingOptions {
  double deviation = 0.0;  ///< standard deviation of a link, dB; 0: none
  double distance = 5.0;   ///< metres over which a robot has to move for another value
};

/// Each place has a value, interpolated between the corners of squares of `distance`; the values of its two ends make
/// that of a link. So robots that stand together are shadowed alike, and who stands badly does so for everybody.
class Shadowing {
 public:
  static constexpr double kLimit = 3.0;  ///< standard deviations that no link exceeds

  Shadowing(const ShadowingOptions& options, std::uint64_t seed) : options_(options), seed_(seed) {}

  /// Of a place; mean 0, standard deviation 1.
  double at(const Position& position) const;
  /// Of a link between places with these values, dB to be subtracted from the received power.
  double between(double here, double there) const;
  /// The most that shadowing adds to a received power, dB.
  double best() const { return kLimit * options_.deviation; }
  bool exists() const { return options_.deviation > 0.0; }

 private:
  double corner(double column, double row) const;

  ShadowingOptions options_;
  std::uint64_t seed_;
};

}  // namespace adhoc_communication
