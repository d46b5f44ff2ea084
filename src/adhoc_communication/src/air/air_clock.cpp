#include "air/air_clock.hpp"

#include <algorithm>

namespace adhoc_communication::air {

const AirRate& AirClock::rate(const MacAddress& destination) const {
  const AirRate* kind = measured(destination);
  return kind == nullptr ? common_ : *kind;
}

const AirRate* AirClock::measured(const MacAddress& destination) const {
  const auto kind = kinds_.find(destination);
  return kind == kinds_.end() ? nullptr : &kind->second;
}

/// Of frames for everybody that is never said without a measurement: on Wi-Fi they are unlike all others.
bool AirClock::calibrated(const MacAddress& destination) const {
  const AirRate* kind = measured(destination);
  if (kind != nullptr) return kind->calibrated();
  return destination != wire::kEverybody && common_.calibrated();
}

/// A bound may be a loose one: the frame may have waited behind others. By itself it does not make a kind known.
void AirClock::bound(const Transmission& transmission, Time longest) {
  const auto kind = kinds_.find(transmission.destination);
  if (kind != kinds_.end()) kind->second.bound(transmission.octets, longest);
  common_.bound(transmission.octets, longest);
}

void AirClock::transmitted(std::uint64_t counter, std::size_t octets, const MacAddress& destination, Time now,
                           AccessCategory category) {
  const bool follows = !recent_.empty() && recent_.back().counter + 1 == counter;
  const Time gap = follows ? now - recent_.back().sent : Time::max();
  const bool in_order = follows && recent_.back().category == category;
  const bool idle = busy_until_ <= now;
  if (recent_.size() == kMostRemembered) recent_.pop_front();
  last_destination_ = destination;
  last_rate_ = &rate(destination);
  busy_until_ = std::max(busy_until_, now) + rate(destination).air_time(octets);
  recent_.push_back({counter, octets, destination, category, now, gap, in_order, false, false, busy_until_, idle});
}

void AirClock::handed_over(bool kept) {
  for (auto latest = recent_.rbegin(); latest != recent_.rend() && latest->counter > handed_over_; ++latest) {
    latest->kept = kept;
  }
  if (!recent_.empty()) handed_over_ = recent_.back().counter;
}

void AirClock::acknowledged(std::uint64_t counter, Time spacing, Time answered, std::size_t octets) {
  if (counter > off_air_) sample(counter, spacing, answered);
  if (!take(counter)) return;
  Time arrived = answered;
  if (const Transmission* last = find(counter)) {
    bound(*last, answered - last->sent);
    sample_delay(*last, answered, octets);
    arrived = arrival(*last, answered, octets);
  }
  busy_until_ = end_of_rest(arrived);
}

/// A radio slower than any that is thought of would look like a delay: there, none is believed.
void AirClock::sample_delay(const Transmission& last, Time answered, std::size_t octets) {
  if (octets == 0 || !last.idle || !calibrated(last.destination)) return;
  const AirRate& known = rate(last.destination);
  const Time on_air = known.air_time(last.octets) + known.air_time(octets);
  const bool slowest = known.air_time(last.octets) >= AirRate::slowest_air_time(last.octets) * 9 / 10;
  delays_ = std::min(delays_ + 1, kEnoughDelays);
  delay_ = slowest ? Time(0) : std::min(delay_, std::max(Time(0), answered - last.sent - on_air));
}

/// The answer has been on the air itself; and where it shares the channel, it may have had to wait for one frame more,
/// which was in the radio already. What fits better to what was believed before is taken: to count that frame twice
/// would leave the air idle after each such answer.
Time AirClock::arrival(const Transmission& last, Time answered, std::size_t octets) const {
  if (octets == 0 || !calibrated(last.destination)) return answered;
  if (delay_ != Time::max()) answered -= delay_;
  const Time directly = std::max(last.sent, answered - rate(last.destination).air_time(octets));
  const auto next = std::upper_bound(
      recent_.begin(), recent_.end(), last.counter,
      [](std::uint64_t number, const Transmission& transmission) { return number < transmission.counter; });
  if (next == recent_.end()) return directly;
  const Time behind_next = directly - rate(next->destination).air_time(next->octets);
  if (next->sent > behind_next) return directly;
  const auto distance = [&](Time time) { return time > last.end ? time - last.end : last.end - time; };
  return distance(behind_next) < distance(directly) ? behind_next : directly;
}

void AirClock::acknowledged_late(std::uint64_t counter, Time spacing, Time now) {
  sample(counter, spacing, now);
  if (take(counter)) busy_until_ = std::min(busy_until_, end_of_rest(now));
}

AirClock::Transmissions::iterator AirClock::first_after(std::uint64_t counter) {
  return std::upper_bound(
      recent_.begin(), recent_.end(), counter,
      [](std::uint64_t number, const Transmission& transmission) { return number < transmission.counter; });
}

AirClock::Transmission* AirClock::find(std::uint64_t counter) {
  const auto after = first_after(counter);
  if (after == recent_.begin() || std::prev(after)->counter != counter) return nullptr;
  return &*std::prev(after);
}

/// All up to this frame are off the air; false if that was known, or nothing of the kind was sent.
bool AirClock::take(std::uint64_t counter) {
  const auto first = first_after(off_air_);
  if (first == recent_.end() || first->counter > counter) return false;
  off_air_ = std::min(counter, recent_.back().counter);
  return true;
}

/// Each frame follows the one before as soon as it is there.
Time AirClock::end_of_rest(Time begin) {
  Time end = begin;
  for (auto transmission = first_after(off_air_); transmission != recent_.end(); ++transmission) {
    end = std::max(end, transmission->sent) + rate(transmission->destination).air_time(transmission->octets);
    transmission->end = end;
  }
  return end;
}

/// One neighbour cannot make the air seem slower than it can be: what it reports is not longer than its answer took
/// since the frame before was handed over, nor than the slowest radio takes.
Time AirClock::credible(const Transmission& transmission, Time spacing, Time answered) const {
  const Time since_former = answered - (transmission.sent - transmission.gap);
  return std::min({spacing, since_former, AirRate::slowest_air_time(transmission.octets)});
}

/// A frame handed over as late as it arrived after the one before may have found the radio idle.
void AirClock::sample(std::uint64_t counter, Time spacing, Time now) {
  Transmission* transmission = find(counter);
  if (transmission == nullptr || transmission->sampled || spacing == Time(0)) return;
  const bool together = spacing < AirRate::fastest_air_time(transmission->octets);
  const auto known = kinds_.find(transmission->destination);
  if (known != kinds_.end() && transmission->in_order) {
    known->second.arrived(together);
    common_.arrived(together);
  }
  if (transmission->gap >= spacing * 4 / 5) return;
  transmission->sampled = true;
  spacing = credible(*transmission, spacing, now);
  AirRate& kind = kinds_[transmission->destination];
  kind.sample(transmission->octets, spacing, now);
  if (transmission->destination != wire::kEverybody) {
    shared_.measured(kind.waits_for_others(), transmission->kept, now);
    if (kind.jittered()) shared_.disproved();
  }
  common_.sample(transmission->octets, spacing, now);
  last_rate_ = &rate(last_destination_);
}

}  // namespace adhoc_communication::air
