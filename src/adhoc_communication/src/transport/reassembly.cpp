#include "transport/reassembly.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication::transport {

bool Reassembly::admit(const Key& key, std::size_t octets, bool next, Time now) {
  const std::size_t cost = octets + kOverhead;
  if (cost > most_of_a_source_) return false;
  if (const std::size_t own = taken_by(key.source); own + cost > most_of_a_source_) {
    const std::vector<Key> later = next ? later_ones(key, own + cost - most_of_a_source_) : std::vector<Key>{};
    if (later.empty()) return false;
    evict(later);
  }
  if (taken_ + cost > most_) {
    const std::size_t needed = taken_ + cost - most_;
    std::vector<Key> victims = youngest(needed, [now](const auto& item) { return has_stalled(item.second, now); });
    if (victims.empty() && next) victims = later_ones(key, needed);
    if (victims.empty()) return false;
    evict(victims);
  }
  taken_ += cost;
  places_[key] = Place{cost, 0, admitted_++, now, now, false};
  return true;
}

bool Reassembly::has_stalled(const Place& place, Time now) {
  if (place.kept) return false;
  if (now - place.last >= kStalled) return true;
  const double age = static_cast<double>((now - place.admitted).count()) * 1e-9;
  return now - place.admitted >= kStalled && static_cast<double>(place.filled) < age * kLeastRate;
}

bool Reassembly::stalled(const Key& key, Time now) const {
  const auto found = places_.find(key);
  return found == places_.end() || has_stalled(found->second, now);
}

std::size_t Reassembly::taken_by(const MacAddress& source) const {
  std::size_t cost = 0;
  for (auto place = places_.lower_bound({source, 0, 0, 0}); place != places_.end(); ++place) {
    if (place->first.source != source) break;
    cost += place->second.kept ? 0 : place->second.cost;
  }
  return cost;
}

/// So many of the youngest candidates as it takes to free `cost`; none if all together do not.
template <typename Predicate>
std::vector<Reassembly::Key> Reassembly::youngest(std::size_t cost, Predicate candidate) const {
  std::vector<Places::const_iterator> candidates;
  for (auto place = places_.begin(); place != places_.end(); ++place) {
    if (candidate(*place)) candidates.push_back(place);
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const auto& a, const auto& b) { return a->second.order > b->second.order; });
  std::vector<Key> keys;
  std::size_t freed = 0;
  for (const auto& place : candidates) {
    if (freed >= cost) break;
    freed += place->second.cost;
    keys.push_back(place->first);
  }
  return freed >= cost ? keys : std::vector<Key>{};
}

std::vector<Reassembly::Key> Reassembly::later_ones(const Key& key, std::size_t cost) const {
  return youngest(cost, [&](const auto& item) {
    const auto& [other, place] = item;
    return !place.kept && other.source == key.source && other.boot == key.boot && other.carrier == key.carrier;
  });
}

void Reassembly::evict(const std::vector<Key>& keys) {
  for (const Key& key : keys) release(key);
  evicted_.insert(evicted_.end(), keys.begin(), keys.end());
}

void Reassembly::progress(const Key& key, std::size_t octets, Time now) {
  const auto found = places_.find(key);
  if (found == places_.end()) return;
  found->second.filled += octets;
  found->second.last = now;
}

void Reassembly::keep(const Key& key) {
  if (const auto found = places_.find(key); found != places_.end()) found->second.kept = true;
}

void Reassembly::release(const Key& key) {
  const auto found = places_.find(key);
  if (found == places_.end()) return;
  taken_ -= found->second.cost;
  places_.erase(found);
}

Reassembly::Fill Reassembly::fill() const {
  Fill fill;
  for (const auto& [key, place] : places_) {
    if (key.carrier < kBroadcast) fill.streams += place.cost;
    if (key.carrier >= kGroup) (place.kept ? fill.complete_groups : fill.groups) += place.cost;
  }
  return fill;
}

std::vector<Reassembly::Key> Reassembly::take_evicted() { return std::exchange(evicted_, {}); }

}  // namespace adhoc_communication::transport
