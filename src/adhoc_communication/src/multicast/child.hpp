// One child in the tree of a group packet: what it misses as far as it has told, and when it is to be asked.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

class Child {
 public:
  static constexpr Time kSubtreePatience = std::chrono::milliseconds(250);  ///< between questions to one that waits
  /// The same at last of one that has it all itself: when those behind it do, it says so and is sure to be heard.
  static constexpr Time kLongestSubtreePatience = std::chrono::seconds(2);
  static constexpr Time kNoProgress = std::chrono::seconds(10);
  static constexpr Time kNoEnd = std::chrono::seconds(30);
  /// Until one that had no room is asked again, and until it is given up.
  static constexpr Time kRoomRetry = std::chrono::milliseconds(100);
  static constexpr Time kRoomPatience = std::chrono::seconds(60);

  /// `sent_in`: by block of the packet, the round of the newest symbol of it that was sent to anybody.
  Child(std::vector<std::uint16_t> sent_in, std::uint32_t coverage, Time patience, Time now);

  /// Other members are behind it now, and it has to report anew.
  void cover(std::uint32_t coverage, Time patience, Time now);
  std::uint32_t coverage() const { return coverage_; }

  /// All behind it have the packet.
  bool done() const { return done_; }
  void finish() { done_ = true; }
  /// Frames are of use to it.
  bool takes() const { return !done_ && !no_room_since_; }
  /// It misses something of the block, or may do so.
  bool misses(std::size_t block) const { return missing_[block] != 0; }
  /// Of those behind it that is not known.
  bool misses_nothing() const;
  /// What it said counts everything that was sent of the block.
  bool knows(std::size_t block) const;
  /// As reported: how many frames, or which; knows() holds.
  std::uint8_t missing(std::size_t block) const { return missing_[block]; }
  void sent(std::size_t block, std::uint16_t round) { sent_in_[block] = round; }

  void asked(Time patience, Time now);
  Time asked_at() const { return asked_; }
  /// When it is to be asked by itself.
  Time due() const { return asked_ + question_wait_; }
  void asked_by_itself(Time now);
  /// It has answered the question that all were asked, and those behind it may still miss something.
  void answered(Time now) { asked(kSubtreePatience, now); }
  /// It has no room: nothing that it has had counts any more.
  void wait_for_room(Time now);
  void has_room(Time now);
  void learn(const wire::GroupReport& report, Time now);
  /// Without progress for kNoProgress, kNoEnd where only those behind it miss something, or kRoomPatience where it has
  /// no room.
  bool stuck(Time now) const;

 private:
  static constexpr std::uint8_t kUnknown = 0xff;

  void learn(std::size_t block, std::uint8_t missing, std::uint16_t round, Time now);
  void know_nothing();
  std::vector<std::uint16_t> sent_in_;   ///< by block: round of the newest symbol that went to it
  std::vector<std::uint8_t> missing_;    ///< by block; kUnknown at first
  std::vector<std::uint16_t> known_in_;  ///< by block: round that `missing_` counts
  std::uint32_t coverage_ = 0;
  bool done_ = false;
  Time asked_{0};
  Time progress_{0};
  Time question_wait_{0};
  std::optional<Time> no_room_since_{};
};

}  // namespace adhoc_communication::multicast
