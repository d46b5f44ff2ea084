#include "api/event_queue.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {

void EventQueue::add(Event event) {
  const auto* packet = std::get_if<PacketReceived>(&event);
  const std::size_t octets = packet == nullptr ? 0 : packet->payload.size();
  if (events_.size() >= kMostEvents) drop_oldest_packet();
  while (octets > 0 && octets_ > 0 && octets_ + octets > kMostOctets) drop_oldest_packet();
  octets_ += octets;
  events_.push_back(std::move(event));
}

void EventQueue::drop_oldest_packet() {
  const auto oldest = std::find_if(events_.begin(), events_.end(),
                                   [](const Event& kept) { return std::holds_alternative<PacketReceived>(kept); });
  if (oldest == events_.end()) return;
  octets_ -= std::get<PacketReceived>(*oldest).payload.size();
  events_.erase(oldest);
}

std::optional<Event> EventQueue::next() {
  if (events_.empty()) return std::nullopt;
  Event event = std::move(events_.front());
  events_.pop_front();
  if (const auto* packet = std::get_if<PacketReceived>(&event)) octets_ -= packet->payload.size();
  return event;
}

}  // namespace adhoc_communication
