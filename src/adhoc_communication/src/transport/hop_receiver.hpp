// What has arrived from one run of a neighbour: for acknowledgments, and to drop repetitions.
#pragma once

#include <cstdint>
#include <optional>

#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

/// Of the frame that brings an acknowledgment, behind the Ethernet header: its body has 36.
constexpr std::size_t kAcknowledgmentOctets = wire::kHeaderSize + 36 + wire::kChecksumSize;

/// How long an acknowledgment is held back that nobody asked for.
struct AcknowledgmentDelays {
  static constexpr Time kQuiet = std::chrono::milliseconds(3);
  static constexpr Time kLongest = std::chrono::milliseconds(10);
  static constexpr Time kMostHeld = std::chrono::milliseconds(60);

  Time quiet = kQuiet;      ///< without a further frame
  Time longest = kLongest;  ///< since the first frame

  /// Where frames come as slowly as they do on a route whose hops share a slow channel, one for each would cost more
  /// air than it saves. `frame`: air time of one of full size; 0: not known.
  static AcknowledgmentDelays of(Time frame);
};

class HopReceiver {
 public:
  static constexpr int kFramesPerAcknowledgment = 8;
  /// A gap is told after so many further frames, so that one acknowledgment tells the next gap, too.
  static constexpr int kFramesAfterGap = 2;
  static constexpr Time kGapDelay = std::chrono::milliseconds(1);

  explicit HopReceiver(wire::BootTag boot) : boot_(boot) {}

  wire::BootTag boot() const { return boot_; }

  /// From now on.
  void delay(const AcknowledgmentDelays& delays) { delays_ = delays; }
  /// True for a frame not seen before.
  bool take(std::uint32_t link_sequence, std::uint64_t counter, bool acknowledge_now, Time now);
  /// When the acknowledgment is due; Time::max() if none is owed.
  Time due() const { return due_; }
  /// Arrival of the first frame that is not acknowledged.
  Time owed_since() const { return owed_since_; }
  wire::HopAcknowledgment acknowledge(Time now);

 private:
  bool mark(std::uint32_t link_sequence, bool& gap);
  /// Takes a frame into account; whether the gap has waited for enough of them.
  bool gap_ripe(bool gap, Time now);

  wire::BootTag boot_;
  AcknowledgmentDelays delays_;
  bool started_ = false;
  std::uint32_t highest_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t newest_counter_ = 0;
  Time newest_arrival_{0};
  Time spacing_{0};
  int unacknowledged_ = 0;
  int frames_since_gap_ = 0;
  std::optional<Time> gap_since_;  ///< found since the last acknowledgment
  Time due_ = Time::max();
  Time owed_since_{0};
};

}  // namespace adhoc_communication::transport
