#include "relay/definitions.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {
namespace {

template <typename Items, typename Source, typename Size>
std::string source_of_most(const Items& items, Source source, Size size) {
  std::map<std::string, std::size_t> sums;
  for (const auto& item : items) sums[source(item)] += size(item);
  return std::max_element(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

}  // namespace

const std::string* Definitions::find(const TypeName& type) const {
  const auto found = by_type_.find(type);
  return found == by_type_.end() ? nullptr : &found->second->definition;
}

std::vector<PacketReceived> Definitions::learn(const TypeName& type, const std::string& definition,
                                               const std::string& source) {
  if (by_type_.count(type) == 0 && definition.size() <= kMostOctets) {
    octets_ += definition.size();
    by_type_[type] = known_.insert(known_.end(), {type, definition, source});
    while (known_.size() > kMostDefinitions || octets_ > kMostOctets) forget_definition();
  }
  std::vector<PacketReceived> released;
  for (auto iterator = held_.begin(); iterator != held_.end();) {
    if (!(iterator->type == type)) {
      ++iterator;
      continue;
    }
    held_octets_ -= iterator->packet.payload.size();
    released.push_back(std::move(iterator->packet));
    iterator = held_.erase(iterator);
  }
  asked_.erase(type);
  return released;
}

bool Definitions::hold(PacketReceived packet, const TypeName& type, Time now) {
  const std::size_t octets = packet.payload.size();
  while (!held_.empty() && (held_.size() >= kMostHeld || held_octets_ + octets > kMostHeldOctets)) {
    drop_oldest_of_most();
  }
  held_octets_ += octets;
  held_.push_back({std::move(packet), type, now});
  forget_unawaited();
  const auto [asked, first] = asked_.try_emplace(type, now);
  if (!first && now - asked->second < kAskAgain) return false;
  asked->second = now;
  return true;
}

bool Definitions::holds(const std::function<bool(const PacketReceived&)>& is_meant) const {
  return std::any_of(held_.begin(), held_.end(), [&](const Held& held) { return is_meant(held.packet); });
}

void Definitions::expire(Time now) {
  while (!held_.empty() && now - held_.front().since >= kPatience) drop(held_.begin());
  forget_unawaited();
}

/// Of the source that keeps most.
void Definitions::forget_definition() {
  const bool too_many = known_.size() > kMostDefinitions;
  const std::string most = source_of_most(
      known_, [](const Known& known) { return known.source; },
      [too_many](const Known& known) { return too_many ? 1 : known.definition.size(); });
  const auto oldest =
      std::find_if(known_.begin(), known_.end(), [&](const Known& known) { return known.source == most; });
  octets_ -= oldest->definition.size();
  by_type_.erase(oldest->type);
  known_.erase(oldest);
}

void Definitions::drop_oldest_of_most() {
  const bool too_many = held_.size() >= kMostHeld;
  const std::string most = source_of_most(
      held_, [](const Held& held) { return held.packet.source; },
      [too_many](const Held& held) { return too_many ? 1 : held.packet.payload.size(); });
  drop(std::find_if(held_.begin(), held_.end(), [&](const Held& held) { return held.packet.source == most; }));
}

void Definitions::drop(std::deque<Held>::iterator held) {
  held_octets_ -= held->packet.payload.size();
  held_.erase(held);
  ++dropped_;
}

std::vector<std::pair<std::string, TypeName>> Definitions::take_overdue(Time now) {
  std::vector<std::pair<std::string, TypeName>> overdue;
  for (auto& [type, asked] : asked_) {
    if (now - asked < kAskAgain) continue;
    const auto latest =
        std::find_if(held_.rbegin(), held_.rend(), [&type = type](const Held& held) { return held.type == type; });
    if (latest == held_.rend()) continue;
    asked = now;
    overdue.emplace_back(latest->packet.source, type);
  }
  return overdue;
}

void Definitions::forget_unawaited() {
  for (auto iterator = asked_.begin(); iterator != asked_.end();) {
    const bool awaited =
        std::any_of(held_.begin(), held_.end(), [&](const Held& held) { return held.type == iterator->first; });
    iterator = awaited ? std::next(iterator) : asked_.erase(iterator);
  }
}

std::uint64_t Definitions::take_dropped() { return std::exchange(dropped_, 0); }

}  // namespace adhoc_communication
