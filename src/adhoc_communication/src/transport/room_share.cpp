#include "transport/room_share.hpp"

#include <algorithm>

namespace adhoc_communication::transport {
namespace {

using Use = RoomShare::Use;

bool brings_less(const RoomShare::Place& place, double rate, Time now) {
  if (now - place.admitted < RoomShare::kStalled) return false;
  return static_cast<double>(place.filled) < static_cast<double>((now - place.admitted).count()) * 1e-9 * rate;
}

bool has_stalled(const RoomShare::Place& place, Time now) {
  if (place.use == Use::kSpare) return false;
  if (now - place.last >= RoomShare::kStalled) return true;
  const double longest = static_cast<double>(RoomShare::kLongestStay.count()) * 1e-9;
  const double rate = std::max(static_cast<double>(RoomShare::kLeastRate), static_cast<double>(place.cost) / longest);
  return place.use == Use::kFills && brings_less(place, rate, now);
}

}  // namespace

RoomShare::Place* RoomShare::find(const PacketKey& key) {
  const auto found = places_.find(key);
  return found == places_.end() ? nullptr : &found->second;
}

bool RoomShare::stalled(const PacketKey& key, Time now) const {
  const auto found = places_.find(key);
  if (found == places_.end()) return true;
  const Place& place = found->second;
  return now - place.last >= kStalled || brings_less(place, static_cast<double>(kLeastRate), now);
}

void RoomShare::release(const PacketKey& key) {
  const auto found = places_.find(key);
  if (found == places_.end()) return;
  taken_ -= found->second.cost;
  places_.erase(found);
}

std::size_t RoomShare::held_by(const MacAddress& source) const {
  std::size_t cost = 0;
  for (auto place = places_.lower_bound({source, 0, 0, 0}); place != places_.end(); ++place) {
    if (place->first.source != source) break;
    cost += place->second.use == Use::kSpare ? 0 : place->second.cost;
  }
  return cost;
}

bool RoomShare::take(const PacketKey& key, std::size_t cost, Time now) {
  if (taken_ + cost > most_ || held_by(key.source) + cost > most_ / 2) return false;
  taken_ += cost;
  places_[key] = Place{cost, 0, admitted_++, now, now, Use::kFills};
  return true;
}

bool RoomShare::take_from_others(const PacketKey& key, std::size_t cost, bool next, Time now,
                                 std::vector<PacketKey>& evicted) {
  if (cost > most_ / 2) return false;
  const std::size_t own = held_by(key.source) + cost;
  const auto stalled = [now](const auto& item) { return has_stalled(item.second, now); };
  const auto later = [&](const auto& item) {
    const PacketKey& other = item.first;
    return next && other.source == key.source && other.boot == key.boot && other.carrier == key.carrier;
  };
  Leaving leaving;
  if (own > most_ / 2) {
    const std::size_t excess = own - most_ / 2;
    add(leaving, excess, false, [&](const auto& item) {
      return item.second.use != Use::kSpare && item.first.source == key.source && (stalled(item) || later(item));
    });
    if (leaving.octets < excess) return false;
  }
  if (taken_ + cost > most_) {
    const std::size_t excess = taken_ + cost - most_;
    const std::size_t own_then = own - leaving.octets;
    add(leaving, excess, true, [](const auto& item) { return item.second.use == Use::kSpare; });
    add(leaving, excess, false, stalled);
    add(leaving, excess, false, later);
    add_of_greediest(leaving, excess, key.source, own_then);
    if (leaving.octets < excess) return false;
  }
  for (const auto& [order, place] : leaving.places) evicted.push_back(place->first);
  for (const auto& [order, place] : leaving.places) release(PacketKey(place->first));
  return take(key, cost, now);
}

/// As many of the candidates as it takes for `octets` in all, or all of them.
template <typename Predicate>
void RoomShare::add(Leaving& leaving, std::size_t octets, bool oldest_first, Predicate candidate) const {
  if (leaving.octets >= octets) return;
  std::vector<Places::const_iterator> candidates;
  for (auto place = places_.begin(); place != places_.end(); ++place) {
    if (candidate(*place)) candidates.push_back(place);
  }
  std::sort(candidates.begin(), candidates.end(), [oldest_first](const auto& a, const auto& b) {
    return oldest_first ? a->second.order < b->second.order : a->second.order > b->second.order;
  });
  for (const auto& place : candidates) {
    if (leaving.octets >= octets) break;
    if (leaving.places.emplace(place->second.order, place).second) leaving.octets += place->second.cost;
  }
}

/// `own`: what the newcomer's source holds then.
void RoomShare::add_of_greediest(Leaving& leaving, std::size_t octets, const MacAddress& newcomer,
                                 std::size_t own) const {
  if (leaving.octets >= octets) return;
  std::map<MacAddress, std::size_t> held;
  for (const auto& [key, place] : places_) {
    if (key.source != newcomer && place.use != Use::kSpare) held[key.source] += place.cost;
  }
  for (const auto& [order, place] : leaving.places) {
    const auto source = held.find(place->first.source);
    if (source != held.end() && place->second.use != Use::kSpare) source->second -= place->second.cost;
  }
  const auto greediest =
      std::max_element(held.begin(), held.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (greediest == held.end()) return;
  Leaving with = leaving;
  add(with, octets, false,
      [&](const auto& item) { return item.first.source == greediest->first && item.second.use != Use::kSpare; });
  if (greediest->second >= own + (with.octets - leaving.octets)) leaving = std::move(with);
}

}  // namespace adhoc_communication::transport
