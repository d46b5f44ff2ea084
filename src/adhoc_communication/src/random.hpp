// The only source of randomness: a generator whose whole future follows from its seed, the same on every machine.
#pragma once

#include <cstdint>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// SplitMix64 (Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  bool chance(double probability) { return uniform() < probability; }
  /// Uniform in [0, longest).
  Time delay(Time longest) { return Time(static_cast<Time::rep>(uniform() * static_cast<double>(longest.count()))); }

 private:
  std::uint64_t state_;
};

}  // namespace adhoc_communication
