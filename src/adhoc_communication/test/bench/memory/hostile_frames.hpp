// Frames that somebody without the key of the team, or with bad intent, may send.
#pragma once

#include <deque>

#include "adhoc_communication/types.hpp"
#include "random.hpp"

namespace adhoc_communication::bench {

/// In turn: random octets; a plausible header with random contents, from a random address; a frame heard before, with
/// altered octets; a frame heard before, once more; a frame heard before, now from a random robot. Where the team has
/// no key, the second and the last carry a right checksum.
class HostileFrames {
 public:
  HostileFrames(bool sealed, std::uint64_t seed) : sealed_(sealed), random_(seed) {}

  /// Frames heard so far are added to what is sent again later, however old it is.
  void listen(const std::deque<Frame>& frames);
  Frame next();

 private:
  static constexpr std::size_t kMostHeard = 20'000;

  Bytes octets(std::size_t most);
  MacAddress anybody();
  Frame garbage();
  Frame plausible();
  Frame altered();
  Frame in_other_name();
  const Frame& heard() { return heard_[random_.next() % heard_.size()]; }

  bool sealed_;
  Random random_;
  std::uint64_t count_ = 0;
  std::deque<Frame> heard_;
};

}  // namespace adhoc_communication::bench
