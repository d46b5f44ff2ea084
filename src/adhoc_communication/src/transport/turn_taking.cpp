#include "transport/turn_taking.hpp"

#include <algorithm>

namespace adhoc_communication::transport {

void TurnTaking::heard(const MacAddress& from, bool last, Time air_time, Time now) {
  const auto found = others_.find(from);
  if (found == others_.end()) return;
  Others& turn = found->second;
  if (turn.ends <= now) turn.frames = 0;
  ++turn.frames;
  const int left = last ? 0 : std::max(0, kFrames - turn.frames);
  const int quiet = turn.comes_back ? kQuietFramesOfRepeating : kQuietFrames;
  turn.ends = left == 0 ? now : now + std::min(left + 1, quiet) * air_time;
  turn.air_time = air_time;
}

Time TurnTaking::ends(const MacAddress& neighbor) const {
  const auto turn = others_.find(neighbor);
  return turn == others_.end() ? Time(0) : turn->second.ends;
}

Time TurnTaking::held_until(const MacAddress& neighbor) const {
  const auto turn = others_.find(neighbor);
  return turn == others_.end() ? Time(0) : turn->second.ends + kLongestHold * turn->second.air_time;
}

Time TurnTaking::opens(const MacAddress& to) const {
  if (goes_on(to)) return Time(0);
  const auto own = own_.find(to);
  Time others_end{0};
  bool follows = false;
  for (const auto& [from, turn] : others_) {
    others_end = std::max(others_end, turn.ends);
    follows = follows || (from != to && own != own_.end() && turn.ends > own->second.begun);
  }
  return own == own_.end() || follows ? others_end : std::max(others_end, own->second.opens);
}

bool TurnTaking::goes_on(const MacAddress& to) const {
  const auto turn = own_.find(to);
  return turn != own_.end() && turn->second.frames > 0;
}

bool TurnTaking::sent(const MacAddress& to, const Frame& frame, Time now) {
  Own& turn = own_[to];
  if (turn.frames > 0 && turn.latest + kQuietFrames * frame.air_time < now) turn.frames = 0;
  if (turn.frames == 0) turn.begun = now;
  turn.latest = now;
  ++turn.frames;
  if (frame.more && turn.frames < kFrames) return false;
  end(turn, frame);
  return true;
}

void TurnTaking::end(Own& turn, const Frame& frame) {
  turn.whole = turn.frames == kFrames;
  turn.comes_back = frame.comes_back;
  turn.opens = turn.begun + longest(turn, frame);
  turn.awaited = turn.whole || turn.comes_back ? frame.counter : 0;
  turn.frames = 0;
}

/// Of a turn that comes back, when its answer must be lost. Otherwise the robots behind need as long for these frames
/// as this one.
Time TurnTaking::longest(Own& turn, const Frame& frame) {
  const int turns = std::min(1 + frame.beyond, kTurnsInReach);
  if (turn.length.smoothed() == Time(0)) {
    turn.length.sample((frame.comes_back ? turns : 1) * kFrames * frame.air_time);
  }
  const Time length = turn.length.smoothed();
  if (frame.comes_back) return length * 3 / 2 + 4 * turn.length.variation();
  return (turns * length + turn.length.variation()) * turn.frames / kFrames;
}

/// One that comes late belongs to another turn, or had to be asked for.
void TurnTaking::answered(const MacAddress& by, std::uint64_t counter, Time now) {
  const auto found = own_.find(by);
  if (found == own_.end() || found->second.awaited == 0 || counter < found->second.awaited) return;
  Own& turn = found->second;
  turn.awaited = 0;
  if (turn.comes_back && turn.frames == 0) turn.opens = now;
  if (turn.whole) turn.length.sample(std::min(now - turn.begun, 2 * turn.length.smoothed()));
}

Time TurnTaking::patience(const MacAddress& to) const {
  const auto turn = own_.find(to);
  if (turn == own_.end()) return Time(0);
  // One that comes back has all turns in reach in it.
  const int turns = turn->second.comes_back ? kTurnsInReach : 2 * kTurnsInReach + 2;
  return turns * turn->second.length.smoothed();
}

Time TurnTaking::next_opening(Time now) const {
  Time next = Time::max();
  for (const auto& [to, turn] : own_) {
    if (opens(to) > now) next = std::min(next, opens(to));
  }
  for (const auto& [from, turn] : others_) {
    if (turn.ends > now) next = std::min(next, turn.ends);
  }
  return next;
}

}  // namespace adhoc_communication::transport
