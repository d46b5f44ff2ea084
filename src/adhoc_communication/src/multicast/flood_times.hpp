// How long members take to say that they have a flooded packet.
#pragma once

#include <algorithm>
#include <deque>

#include "multicast/receipt.hpp"
#include "transport/round_trip.hpp"

namespace adhoc_communication::multicast {

struct PacketNumber {
  std::uint8_t stream;
  std::uint32_t number;
};

/// What is said after it was given up counts, too: otherwise a timeout that is too short would stay so, and fill a
/// crowded channel with copies of what has arrived. Of the latest kMostGivenUp only; the oldest make room.
class FloodTimes {
 public:
  static constexpr std::size_t kMostGivenUp = 1024;
  static constexpr int kRemembered = 512;                    ///< words, of the slowest
  static constexpr Time kLongest = std::chrono::seconds(4);  ///< later words are of later packets, or of the copy

  Time timeout() const { return std::min(std::max(time_.timeout(), slowest_ + slowest_ / 2), kLongest); }
  void sample(Time time) {
    time_.sample(time);
    slowest_ = time > slowest_ ? time : slowest_ - (slowest_ - time) / kRemembered;
  }

  /// The member has not said in time that it has the packet that was sent then.
  void given_up(const MacAddress& member, PacketNumber packet, Time sent) {
    if (given_up_.size() == kMostGivenUp) given_up_.pop_front();
    given_up_.push_back({member, packet, sent});
  }
  /// A copy has brought the packet there: what the member says of it now tells nothing of floods.
  void copied(const MacAddress& member, PacketNumber packet) {
    const auto is_it = [&](const GivenUp& one) {
      return one.member == member && one.packet.stream == packet.stream && one.packet.number == packet.number;
    };
    given_up_.erase(std::remove_if(given_up_.begin(), given_up_.end(), is_it), given_up_.end());
  }
  void told(const wire::GroupReceipt& receipt, Time now) {
    const auto is_done = [&](const GivenUp& one) {
      if (now - one.sent > kLongest) return true;
      const bool is_there = one.member == receipt.member && one.packet.stream == receipt.stream &&
                            had(receipt, one.packet.number) != Had::kNot;
      if (is_there) sample(now - one.sent);
      return is_there;
    };
    given_up_.erase(std::remove_if(given_up_.begin(), given_up_.end(), is_done), given_up_.end());
  }

 private:
  struct GivenUp {
    MacAddress member;
    PacketNumber packet;
    Time sent;
  };

  transport::RoundTrip time_{std::chrono::milliseconds(500), std::chrono::milliseconds(200), kLongest};
  Time slowest_{0};
  std::deque<GivenUp> given_up_;
};

}  // namespace adhoc_communication::multicast
