// What has arrived from one run of a neighbour: for acknowledgments, and to drop repetitions.
#pragma once

#include <cstdint>

#include "wire/messages.hpp"

namespace adhoc_communication::transport {

class HopReceiver {
 public:
  static constexpr int kFramesPerAcknowledgment = 8;
  static constexpr Time kLongestDelay = std::chrono::milliseconds(3);

  explicit HopReceiver(wire::BootTag boot) : boot_(boot) {}

  wire::BootTag boot() const { return boot_; }

  /// True for a frame not seen before.
  bool take(std::uint32_t link_sequence, std::uint64_t counter, bool acknowledge_now, Time now);
  /// When the acknowledgment is due; Time::max() if none is owed.
  Time due() const { return due_; }
  /// Arrival of the first frame that is not acknowledged.
  Time owed_since() const { return owed_since_; }
  wire::HopAcknowledgment acknowledge(Time now);

 private:
  bool mark(std::uint32_t link_sequence, bool& gap);

  wire::BootTag boot_;
  bool started_ = false;
  std::uint32_t highest_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t newest_counter_ = 0;
  Time newest_arrival_{0};
  Time spacing_{0};
  int unacknowledged_ = 0;
  Time due_ = Time::max();
  Time owed_since_{0};
};

}  // namespace adhoc_communication::transport
