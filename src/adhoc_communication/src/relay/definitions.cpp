#include "relay/definitions.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {

const std::string* Definitions::find(const TypeName& type) const {
  const auto found = by_type_.find(type);
  return found == by_type_.end() ? nullptr : &found->second->definition;
}

std::vector<PacketReceived> Definitions::learn(const TypeName& type, const std::string& definition) {
  if (by_type_.count(type) == 0 && definition.size() <= kMostOctets) {
    octets_ += definition.size();
    by_type_[type] = known_.insert(known_.end(), {type, definition});
    while (known_.size() > kMostDefinitions || octets_ > kMostOctets) {
      octets_ -= known_.front().definition.size();
      by_type_.erase(known_.front().type);
      known_.pop_front();
    }
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
  while (!held_.empty() && (held_.size() >= kMostHeld || held_octets_ + octets > kMostHeldOctets)) drop_oldest();
  held_octets_ += octets;
  held_.push_back({std::move(packet), type, now});
  forget_unawaited();
  const auto [asked, first] = asked_.try_emplace(type, now);
  if (!first && now - asked->second < kAskAgain) return false;
  asked->second = now;
  return true;
}

void Definitions::expire(Time now) {
  while (!held_.empty() && now - held_.front().since >= kPatience) drop_oldest();
  forget_unawaited();
}

void Definitions::drop_oldest() {
  held_octets_ -= held_.front().packet.payload.size();
  held_.pop_front();
  ++dropped_;
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
