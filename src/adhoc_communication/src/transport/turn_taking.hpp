// Whose turn it is where the hops of a route share one channel.
#pragma once

#include <cstdint>
#include <iterator>
#include <map>

#include "transport/hop_receiver.hpp"
#include "transport/round_trip.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

/// Two robots with one in between do not hear each other, and what both send at once is lost for the one in between. So
/// frames travel along a route in turns: of up to kFrames, handed to the radio together, the last of which asks for an
/// answer. Then it is the turn of the next robot to pass them on. Who has begun waits until that one and the one behind
/// it have had theirs; a relay begins when the turn of the robot before it ends, and so keeps the rhythm of the source.
/// On a way of two or three hops only one robot may send at a time. There a relay answers when the next robot has what
/// the turn brought, and the answer begins the next turn.
class TurnTaking {
 public:
  static constexpr int kFrames = HopReceiver::kFramesPerAcknowledgment;
  static constexpr int kQuietFrames = 4;    ///< so long without a frame the turn of another robot is over
  static constexpr int kTurnsInReach = 3;   ///< of robots in a row: the first and the fourth may send at once
  static constexpr int kShortestRoute = 2;  ///< in hops
  /// The same where turns come back: the radio repeats frames by itself, and none of a turn is lost.
  static constexpr int kQuietFramesOfRepeating = 8;
  static constexpr int kLongestHold = 2 * kTurnsInReach * kFrames;  ///< in air times of a frame

  /// On a way of so many hops the answer gives the turn back.
  static bool comes_back(std::uint8_t route) { return route >= kShortestRoute && route <= kTurnsInReach; }
  /// What fits into one turn waits for none: it is gone before others could be in its way.
  static bool fills_turns(const wire::Data& data) { return data.total > kFrames * std::uint32_t{data.segment_size}; }

  /// What is to be known of a frame that goes out.
  struct Frame {
    std::uint64_t counter;
    bool more;            ///< another one could follow it at once
    std::uint8_t beyond;  ///< hops that it has to go when the neighbour has it
    Time air_time;        ///< of a frame of full size
    bool comes_back = false;
  };

  /// The neighbour sends what this robot passes on in turns.
  void follow(const MacAddress& neighbor, bool comes_back = false) { others_[neighbor].comes_back = comes_back; }
  void follow_no_more(const MacAddress& neighbor) { others_.erase(neighbor); }
  /// Data from a neighbour; `last`: it waits for an answer.
  void heard(const MacAddress& from, bool last, Time air_time, Time now);
  /// Whether the neighbour's turn is not over; until when, at the latest.
  Time ends(const MacAddress& neighbor) const;
  /// So long at most its answer is held back, while what the turn brought is passed on.
  Time held_until(const MacAddress& neighbor) const;

  /// When the next frame may go there; the time is past if it may now.
  Time opens(const MacAddress& to) const;
  /// A turn there has begun and is not over: what follows belongs to it.
  bool goes_on(const MacAddress& to) const;
  /// A frame goes there. Whether it is the last one of the turn.
  bool sent(const MacAddress& to, const Frame& frame, Time now);
  void answered(const MacAddress& by, std::uint64_t counter, Time now);
  /// An answer that is lost is made up for by that of the next turn, or of the one behind it.
  Time patience(const MacAddress& to) const;

  /// The first time after `now` at which a turn opens.
  Time next_opening(Time now) const;
  template <typename Predicate>
  void forget_if(const Predicate& is_gone) {
    for (auto turn = own_.begin(); turn != own_.end();) {
      turn = is_gone(turn->first) ? own_.erase(turn) : std::next(turn);
    }
    for (auto turn = others_.begin(); turn != others_.end();) {
      turn = is_gone(turn->first) ? others_.erase(turn) : std::next(turn);
    }
  }

 private:
  struct Own {
    int frames = 0;  ///< of the turn that goes on
    Time begun{0};
    Time latest{0};
    Time opens{0};
    std::uint64_t awaited = 0;  ///< the frame whose answer is waited for; 0: none
    bool whole = false;         ///< so that its answer tells how long a turn takes
    bool comes_back = false;
    RoundTrip length{Time(0), Time(0), Time::max()};
  };
  struct Others {
    int frames = 0;
    Time ends{0};
    Time air_time{0};
    bool comes_back = false;
  };

  static void end(Own& turn, const Frame& frame);
  static Time longest(Own& turn, const Frame& frame);

  std::map<MacAddress, Own> own_;
  std::map<MacAddress, Others> others_;
};

}  // namespace adhoc_communication::transport
