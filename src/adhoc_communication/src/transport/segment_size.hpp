// How long the segments of packets to one robot may be, where robots on the way take shorter frames than this one.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication::transport {

/// A frame that an interface on the way does not take is lost without a word (as in RFC 4821): only that nothing of a
/// packet arrives tells it. Since other things may be the reason, longer segments are tried again after some time.
class SegmentSize {
 public:
  static constexpr std::uint16_t kShortest = 256;  ///< fits a data frame at the smallest MTU allowed
  static constexpr Time kShortestMemory = std::chrono::seconds(10);
  static constexpr Time kLongestMemory = std::chrono::seconds(600);

  /// Of a packet that begins now; `most`: what this robot's own frames take.
  std::uint16_t of_packet(std::uint16_t most, Time now) {
    if (limit_ && now >= forgotten_) limit_.reset();
    return std::min(most, limit_.value_or(most));
  }
  /// Nothing of a packet cut into segments of `size` arrives: what to try next, if anything.
  std::optional<std::uint16_t> shorter(std::uint16_t size, Time now) {
    if (size <= kShortest) return std::nullopt;
    limit_ = std::max<std::uint16_t>(size / 2, kShortest);
    forgotten_ = now + memory_;
    memory_ = std::min<Time>(4 * memory_, kLongestMemory);
    return limit_;
  }
  /// A segment of `size` has arrived.
  void arrived(std::uint16_t size) {
    if (!limit_ || size > *limit_) reset();
  }
  void reset() { *this = {}; }

 private:
  std::optional<std::uint16_t> limit_;
  Time forgotten_{0};
  Time memory_ = kShortestMemory;
};

}  // namespace adhoc_communication::transport
