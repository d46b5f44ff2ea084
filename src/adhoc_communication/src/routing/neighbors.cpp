#include "routing/neighbors.hpp"

#include <algorithm>

namespace adhoc_communication::routing {

bool Neighbors::candidate(const MacAddress& address, wire::BootTag boot, Time now) {
  const std::pair key(address, boot);
  const bool listed = candidates_.count(key) != 0;
  if (!listed && candidates_.size() >= kMostNeighbors) return false;
  candidates_[key] = now;
  return !listed;
}

Neighbor* Neighbors::heard(const MacAddress& address, wire::BootTag boot, Time now) {
  auto found = neighbors_.find(address);
  if (found == neighbors_.end()) {
    if (neighbors_.size() >= kMostNeighbors) return nullptr;
    found = neighbors_.emplace(address, Neighbor{}).first;
    found->second.boot = boot;
  }
  Neighbor& neighbor = found->second;
  if (neighbor.boot != boot) {
    neighbor = Neighbor{};
    neighbor.boot = boot;
  }
  neighbor.last_heard = now;
  candidates_.erase({address, boot});
  return &neighbor;
}

void Neighbors::beacon(const MacAddress& address, const wire::Beacon& beacon, const wire::HeardNeighbor& self,
                       Time now) {
  const auto found = neighbors_.find(address);
  if (found == neighbors_.end()) return;
  Neighbor& neighbor = found->second;
  neighbor.hears.clear();
  for (const wire::HeardNeighbor& heard : beacon.heard) {
    neighbor.hears.push_back(heard.address);
    if (heard.address == self.address && heard.boot == self.boot) neighbor.listed = now;
  }
}

void Neighbors::link_failed(const MacAddress& address) {
  const auto found = neighbors_.find(address);
  if (found != neighbors_.end()) found->second.listed.reset();
}

const Neighbor* Neighbors::find(const MacAddress& address) const {
  const auto found = neighbors_.find(address);
  return found == neighbors_.end() ? nullptr : &found->second;
}

bool Neighbors::two_way(const MacAddress& address, Time now) const {
  const Neighbor* neighbor = find(address);
  return neighbor != nullptr && neighbor->listed && now - *neighbor->listed < timings_.neighbor_timeout;
}

std::vector<MacAddress> Neighbors::all_two_way(Time now) const {
  std::vector<MacAddress> result;
  for (const auto& [address, neighbor] : neighbors_) {
    if (two_way(address, now)) result.push_back(address);
  }
  return result;
}

std::vector<wire::HeardNeighbor> Neighbors::heard_list(std::size_t most, Time now) const {
  std::vector<std::pair<Time, wire::HeardNeighbor>> recent;
  for (const auto& [address, neighbor] : neighbors_) {
    if (now - neighbor.last_heard < timings_.neighbor_timeout)
      recent.push_back({neighbor.last_heard, {address, neighbor.boot}});
  }
  for (const auto& [run, last_heard] : candidates_) recent.push_back({last_heard, {run.first, run.second}});
  if (recent.size() > most) {
    std::stable_sort(recent.begin(), recent.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    recent.resize(most);
  }
  std::vector<wire::HeardNeighbor> result;
  for (const auto& item : recent) result.push_back(item.second);
  return result;
}

bool Neighbors::all_hear(const MacAddress& robot, Time now) const {
  return std::all_of(neighbors_.begin(), neighbors_.end(), [&](const auto& item) {
    const auto& [address, neighbor] = item;
    if (address == robot || !two_way(address, now)) return true;
    return std::find(neighbor.hears.begin(), neighbor.hears.end(), robot) != neighbor.hears.end();
  });
}

std::vector<MacAddress> Neighbors::remove_silent(Time timeout, Time now) {
  for (auto iterator = candidates_.begin(); iterator != candidates_.end();) {
    iterator = now - iterator->second < timings_.neighbor_timeout ? std::next(iterator) : candidates_.erase(iterator);
  }
  std::vector<MacAddress> removed;
  for (auto iterator = neighbors_.begin(); iterator != neighbors_.end();) {
    if (now - iterator->second.last_heard < timeout) {
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
    if (!neighbor.listed || now - *neighbor.listed < timings_.neighbor_timeout) continue;
    neighbor.listed.reset();
    silent.push_back(address);
  }
  return silent;
}

void Neighbors::set_loss(const MacAddress& address, double loss) {
  const auto found = neighbors_.find(address);
  if (found != neighbors_.end()) found->second.loss = loss;
}

}  // namespace adhoc_communication::routing
