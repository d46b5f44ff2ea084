#include "transport/reassembly.hpp"

#include <utility>

namespace adhoc_communication::transport {

bool Reassembly::admit(const Key& key, std::size_t octets, bool next, Time now) {
  const std::size_t cost = octets + kOverhead;
  const bool little = octets <= most_little_;
  if ((little && little_.take(key, cost, now)) || whole_.take(key, cost, now)) return true;
  return (little && little_.take_from_others(key, cost, next, now, evicted_)) ||
         whole_.take_from_others(key, cost, next, now, evicted_);
}

RoomShare::Place* Reassembly::find(const Key& key) {
  RoomShare::Place* place = little_.find(key);
  return place != nullptr ? place : whole_.find(key);
}

bool Reassembly::stalled(const Key& key, Time now) const {
  return little_.stalled(key, now) && whole_.stalled(key, now);
}

void Reassembly::progress(const Key& key, std::size_t octets, Time now) {
  RoomShare::Place* place = find(key);
  if (place == nullptr) return;
  place->filled += octets;
  place->last = now;
}

void Reassembly::keep(const Key& key, Time now) {
  RoomShare::Place* place = find(key);
  if (place == nullptr) return;
  place->use = RoomShare::Use::kKept;
  place->last = now;
}

void Reassembly::spare(const Key& key) {
  if (RoomShare::Place* place = find(key)) place->use = RoomShare::Use::kSpare;
}

void Reassembly::release(const Key& key) {
  little_.release(key);
  whole_.release(key);
}

Reassembly::Fill Reassembly::fill() const {
  Fill fill;
  for (const RoomShare* share : {&whole_, &little_}) {
    for (const auto& [key, place] : share->places()) {
      if (key.carrier < kBroadcast) fill.streams += place.cost;
      const bool complete = place.use != RoomShare::Use::kFills;
      if (key.carrier >= kGroup) (complete ? fill.complete_groups : fill.groups) += place.cost;
    }
  }
  return fill;
}

std::vector<Reassembly::Key> Reassembly::take_evicted() { return std::exchange(evicted_, {}); }

}  // namespace adhoc_communication::transport
