#include "routing/neighbors.hpp"

#include <algorithm>
#include <cmath>

namespace adhoc_communication::routing {
namespace {

constexpr int kBeaconsThatMatter = 8;  ///< for the loss of a link: robots on the move are elsewhere after more
/// What counts before the first beacon of a robot: one heard, one lost (the rule of succession). A robot that comes
/// into reach is far away, and its first beacon says little of those that follow.
constexpr int kBeaconsBefore = 2;
constexpr int kBeaconsInDoubt = 2;
constexpr Time kSilenceInDoubt = std::chrono::seconds(1);
constexpr double kHopeless = 0.6;                        ///< loss of a link over which silence is no surprise
constexpr Time kSoon = std::chrono::milliseconds(1500);  ///< so much more silence settles by itself who is gone
constexpr Time kShortestInterval = std::chrono::milliseconds(50);
constexpr Time kLongestInterval = std::chrono::seconds(10);
constexpr int kLongestPause = 6;    ///< 64 intervals between two times that a candidate is named
constexpr double kUsualLoss = 0.3;  ///< of beacons, up to which ALLOWED_HELLO_LOSS of them are waited for
constexpr int kMostMissed = 64;     ///< a greater gap says nothing about the link

}  // namespace

bool Neighbors::candidate(const MacAddress& address, wire::BootTag boot, Time now) {
  const std::pair key(address, boot);
  const auto known = candidates_.find(key);
  if (known != candidates_.end()) {
    known->second.heard = now;
    return false;
  }
  if (candidates_.size() >= kMostNeighbors) {
    candidates_.erase(std::max_element(candidates_.begin(), candidates_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.second.times, b.second.heard) < std::pair(b.second.times, a.second.heard);
    }));
  }
  candidates_[key] = {boot, now, now, 0};
  return true;
}

bool Neighbors::waits(const Candidate& candidate, Time now) const {
  if (now - candidate.heard >= timings_.allowed_hello_loss * own_interval_) return false;
  const Time pause = candidate.times == 0 ? Time(0) : own_interval_ * (1 << std::min(candidate.times, kLongestPause));
  return now - candidate.named >= pause;
}

/// Those named least often come first.
std::vector<wire::HeardNeighbor> Neighbors::next_candidates(std::size_t most, Time now) {
  std::vector<Candidate*> waiting;
  for (auto& [run, candidate] : candidates_) {
    if (waits(candidate, now)) waiting.push_back(&candidate);
  }
  std::stable_sort(waiting.begin(), waiting.end(), [](const Candidate* a, const Candidate* b) {
    return std::pair(a->times, a->named) < std::pair(b->times, b->named);
  });
  if (waiting.size() > most) waiting.resize(most);
  std::vector<wire::HeardNeighbor> result;
  for (Candidate* candidate : waiting) {
    candidate->named = now;
    ++candidate->times;
    result.push_back({wire::neighbor_tag(candidate->boot), 0});
  }
  return result;
}

Neighbor* Neighbors::heard(const MacAddress& address, wire::BootTag boot, Time now) {
  auto found = neighbors_.find(address);
  if (found == neighbors_.end()) {
    if (neighbors_.size() >= kMostNeighbors) make_room();
    if (neighbors_.size() >= kMostNeighbors) return nullptr;
    found = neighbors_.emplace(address, Neighbor{}).first;
    found->second.boot = boot;
    found->second.interval = own_interval_;
  }
  Neighbor& neighbor = found->second;
  if (neighbor.boot != boot) {
    neighbor = Neighbor{};
    neighbor.boot = boot;
    neighbor.interval = own_interval_;
  }
  neighbor.last_heard = now;
  neighbor.failed = false;
  candidates_.erase({address, boot});
  return &neighbor;
}

void Neighbors::make_room() {
  const auto worth = [](const auto& item) { return std::pair(item.second.listed.has_value(), item.second.last_heard); };
  const auto least = std::min_element(neighbors_.begin(), neighbors_.end(),
                                      [&](const auto& a, const auto& b) { return worth(a) < worth(b); });
  if (!least->second.listed) neighbors_.erase(least);
}

void Neighbors::beacon(const MacAddress& address, const wire::Beacon& beacon, wire::NeighborTag self, Time now) {
  const auto found = neighbors_.find(address);
  if (found == neighbors_.end()) return;
  Neighbor& neighbor = found->second;
  neighbor.interval = beacon.interval_ms == 0 ? own_interval_
                                              : std::clamp<Time>(std::chrono::milliseconds(beacon.interval_ms),
                                                                 kShortestInterval, kLongestInterval);
  if (beacon.heard_count != 0 && !beacon.heard.empty()) {
    const std::size_t beacons = (beacon.heard_count + beacon.heard.size() - 1) / beacon.heard.size();
    neighbor.beacons_per_list = static_cast<int>(std::min<std::size_t>(beacons, kLongestList));
  }
  count_beacon(neighbor, beacon.number);
  if (neighbor.hears.size() > kMostNeighbors) neighbor.hears.clear();
  for (const wire::HeardNeighbor& heard : beacon.heard) {
    neighbor.hears[heard.tag] = {now, heard.loss / 255.0};
    if (heard.tag != self) continue;
    neighbor.listed = now;
    neighbor.reported_loss = heard.loss / 255.0;
  }
}

void Neighbors::count_beacon(Neighbor& neighbor, std::uint16_t number) {
  const auto ahead = static_cast<std::uint16_t>(number - neighbor.last_beacon);
  if (neighbor.beacons != 0 && ahead == 0) return;
  const int missed = neighbor.beacons == 0 || ahead > kMostMissed ? 0 : ahead - 1;
  neighbor.last_beacon = number;
  for (int i = 0; i <= missed; ++i) {
    neighbor.beacons = std::clamp(neighbor.beacons + 1, kBeaconsBefore + 1, kBeaconsThatMatter);
    neighbor.loss_from += ((i < missed ? 1.0 : 0.0) - neighbor.loss_from) / neighbor.beacons;
  }
}

void Neighbors::acknowledged(const MacAddress& address, Time now) {
  const auto found = neighbors_.find(address);
  if (found == neighbors_.end()) return;
  found->second.listed = now;
  found->second.blacklisted_until = Time(0);
}

void Neighbors::addressed(const MacAddress& address, Time now) {
  const auto found = neighbors_.find(address);
  if (found != neighbors_.end() && found->second.listed) found->second.listed = now;
}

void Neighbors::link_failed(const MacAddress& address) {
  const auto found = neighbors_.find(address);
  if (found == neighbors_.end()) return;
  found->second.listed.reset();
  found->second.failed = true;
}

void Neighbors::blacklist(const MacAddress& address, Time now) {
  const auto found = neighbors_.find(address);
  if (found != neighbors_.end()) found->second.blacklisted_until = now + timings_.blacklist_timeout();
}

const Neighbor* Neighbors::find(const MacAddress& address) const {
  const auto found = neighbors_.find(address);
  return found == neighbors_.end() ? nullptr : &found->second;
}

bool Neighbors::two_way(const Neighbor& neighbor, Time now) const {
  return neighbor.listed && !fell_silent(neighbor, now) && neighbor.blacklisted_until <= now;
}

/// As to whether it hears this robot.
bool Neighbors::fell_silent(const Neighbor& neighbor, Time now) const {
  return neighbor.listed && now - *neighbor.listed >= patience(neighbor) * neighbor.beacons_per_list;
}

bool Neighbors::is_lost(const Neighbor& neighbor, Time now) const {
  return neighbor.failed || fell_silent(neighbor, now);
}

bool Neighbors::two_way(const MacAddress& address, Time now) const {
  const Neighbor* neighbor = find(address);
  return neighbor != nullptr && two_way(*neighbor, now);
}

std::vector<MacAddress> Neighbors::all_two_way(Time now) const {
  std::vector<MacAddress> result;
  for (const auto& [address, neighbor] : neighbors_) {
    if (two_way(neighbor, now)) result.push_back(address);
  }
  return result;
}

Cost Neighbors::cost(const MacAddress& address) const {
  const Neighbor* neighbor = find(address);
  return neighbor == nullptr ? kPerfectHop : link_cost(loss(address), neighbor->loss_from);
}

double Neighbors::loss(const MacAddress& address) const {
  const Neighbor* neighbor = find(address);
  if (neighbor == nullptr) return 0.0;
  return link_layer_.loss(neighbor->reported_loss, neighbor->seen_loss);
}

double Neighbors::beacon_loss(const MacAddress& address) const {
  const Neighbor* neighbor = find(address);
  return neighbor == nullptr ? 0.0 : neighbor->reported_loss;
}

/// Beacons of a lossy link may well be missed one after the other: as many more as make that equally unlikely. A
/// hopeless one is not held: two good hops are better.
Time Neighbors::patience(const Neighbor& neighbor) const {
  const double loss = neighbor.loss_from;
  const bool known = neighbor.beacons >= kBeaconsThatMatter;
  if (!known || loss <= kUsualLoss || loss >= kHopeless) return timings_.allowed_hello_loss * neighbor.interval;
  const double beacons = timings_.allowed_hello_loss * std::log(kUsualLoss) / std::log(loss);
  return static_cast<int>(std::lround(beacons)) * neighbor.interval;
}

Time Neighbors::patience(const MacAddress& address) const {
  const Neighbor* neighbor = find(address);
  return neighbor == nullptr ? timings_.allowed_hello_loss * own_interval_ : patience(*neighbor);
}

std::vector<wire::HeardNeighbor> Neighbors::next_heard(std::size_t most, Time now) {
  std::vector<wire::HeardNeighbor> result = next_candidates(most / 4, now);
  std::vector<Neighbor*> waiting;
  for (auto& [address, neighbor] : neighbors_) {
    if (now - neighbor.last_heard < patience(neighbor)) waiting.push_back(&neighbor);
  }
  std::stable_sort(waiting.begin(), waiting.end(),
                   [](const Neighbor* a, const Neighbor* b) { return a->named < b->named; });
  for (Neighbor* neighbor : waiting) {
    if (result.size() >= most) break;
    neighbor->named = now;
    result.push_back({wire::neighbor_tag(neighbor->boot), static_cast<std::uint8_t>(neighbor->loss_from * 255)});
  }
  return result;
}

std::size_t Neighbors::heard_count(Time now) const {
  const auto counts = [&](const auto& item) { return now - item.second.last_heard < patience(item.second); };
  return static_cast<std::size_t>(std::count_if(neighbors_.begin(), neighbors_.end(), counts));
}

bool Neighbors::all_hear(const MacAddress& robot, wire::BootTag boot, Time now) const {
  return std::all_of(neighbors_.begin(), neighbors_.end(), [&](const auto& item) {
    const auto& [address, neighbor] = item;
    if (address == robot || !two_way(neighbor, now)) return true;
    return hears(neighbor, wire::neighbor_tag(boot), now) != nullptr;
  });
}

const Neighbor::Hears* Neighbors::hears(const Neighbor& neighbor, wire::NeighborTag robot, Time now) const {
  const auto found = neighbor.hears.find(robot);
  if (found == neighbor.hears.end()) return nullptr;
  return now - found->second.said < patience(neighbor) * neighbor.beacons_per_list ? &found->second : nullptr;
}

double Neighbors::delivery(const Neighbor& neighbor, wire::NeighborTag robot, Time now) const {
  const Neighbor::Hears* found = hears(neighbor, robot, now);
  return found == nullptr ? 0.0 : 1.0 - found->loss;
}

bool Neighbors::bypassed(const MacAddress& from, wire::NeighborTag self, Time now) const {
  const Neighbor* sender = find(from);
  if (sender == nullptr) return false;
  const auto reaches = [&](const Neighbor& other, wire::NeighborTag robot) {
    return hears(other, robot, now) != nullptr;
  };
  return std::any_of(neighbors_.begin(), neighbors_.end(), [&](const auto& item) {
    const Neighbor& other = item.second;
    if (item.first == from || !two_way(other, now)) return false;
    if (reaches(other, wire::neighbor_tag(sender->boot))) return true;
    return std::any_of(other.hears.begin(), other.hears.end(), [&](const auto& heard) {
      return heard.first != self && reaches(other, heard.first) && reaches(*sender, heard.first);
    });
  });
}

std::size_t Neighbors::ways_round(const MacAddress& address, const std::vector<MacAddress>& all, Time now) const {
  const Neighbor& receiver = *find(address);
  const auto ways = std::count_if(all.begin(), all.end(), [&](const MacAddress& other) {
    const wire::NeighborTag tag = wire::neighbor_tag(find(other)->boot);
    return other != address && loss(other) <= kBadLoss && delivery(receiver, tag, now) >= 1.0 - kBadLoss;
  });
  return static_cast<std::size_t>(ways);
}

bool Neighbors::depends(const MacAddress& address, const std::vector<MacAddress>& all, Time now) const {
  return loss(address) <= kBadLoss || ways_round(address, all, now) == 0;
}

/// Silence that is more than a beacon which came late.
Time Neighbors::doubt(const Neighbor& neighbor) {
  return std::max(kBeaconsInDoubt * neighbor.interval, kSilenceInDoubt);
}

bool Neighbors::silent(const MacAddress& address, Time now) const {
  const Neighbor* neighbor = find(address);
  return neighbor == nullptr || silent(*neighbor, now);
}

std::vector<MacAddress> Neighbors::doubtful(Time now) const {
  std::vector<MacAddress> result;
  for (const auto& [address, neighbor] : neighbors_) {
    if (!two_way(neighbor, now) || neighbor.loss_from > kHopeless) continue;
    if (patience(neighbor) - doubt(neighbor) <= kSoon) continue;
    const bool unlisted = now - *neighbor.listed > doubt(neighbor) * neighbor.beacons_per_list;
    if (silent(neighbor, now) || unlisted) result.push_back(address);
  }
  return result;
}

std::vector<MacAddress> Neighbors::remove_silent(Time timeout, Time now) {
  for (auto iterator = candidates_.begin(); iterator != candidates_.end();) {
    const bool remembered = now - iterator->second.heard < kCandidateMemory;
    iterator = remembered ? std::next(iterator) : candidates_.erase(iterator);
  }
  std::vector<MacAddress> removed;
  for (auto iterator = neighbors_.begin(); iterator != neighbors_.end();) {
    if (now - iterator->second.last_heard < std::max(timeout, patience(iterator->second))) {
      ++iterator;
      continue;
    }
    removed.push_back(iterator->first);
    iterator = neighbors_.erase(iterator);
  }
  return removed;
}

std::vector<MacAddress> Neighbors::newly_silent(Time now) {
  std::vector<MacAddress> silent;
  for (auto& [address, neighbor] : neighbors_) {
    if (!fell_silent(neighbor, now)) continue;
    neighbor.listed.reset();
    neighbor.failed = now - neighbor.last_heard >= patience(neighbor);
    silent.push_back(address);
  }
  return silent;
}

void Neighbors::set_loss(const MacAddress& address, std::optional<double> loss) {
  const auto found = neighbors_.find(address);
  if (found == neighbors_.end()) return;
  found->second.seen_loss = loss;
  if (loss) link_layer_.compare(found->second.reported_loss, *loss);
}

}  // namespace adhoc_communication::routing
