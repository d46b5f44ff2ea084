// Sends that end before they are delivered: their lifetime is over, or a newer packet takes their place.
#include <cstdio>

#include "engine_implementation.hpp"

namespace adhoc_communication {

using transport::Image;

namespace {

std::string lifetime_text(Time lifetime) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g s", static_cast<double>(lifetime.count()) * 1e-9);
  return text;
}

}  // namespace

/// True when the packet has got the place of the former one of its subject in whatever queue that waits.
bool Engine::Implementation::takes_place(SendId id, const transport::SendTerms::Subject& subject, const Image& image,
                                         Time now) {
  const auto former = terms_.newest(subject);
  terms_.make_newest(id, subject);
  if (!former || !replace(*former, id, image, now)) return false;
  finish(*former, false, "a newer packet for topic '" + subject.second + "' has taken its place", now, true);
  return true;
}

bool Engine::Implementation::replace(SendId former, SendId id, const Image& image, Time now) {
  const Sending& waiting = sendings_.at(former);
  if (waiting.priority != sendings_.at(id).priority) return false;
  const auto priority = static_cast<std::uint8_t>(waiting.priority);
  if (waiting.destination.empty()) {
    return broadcasts_[priority].replace(former, id, image, static_cast<std::uint16_t>(broadcast_segment_size_));
  }
  if (waiting.destination == multicast::group_of(self_.name)) return replace_in_own_group(former, id, image, now);
  if (multicast::root_of(waiting.destination))
    return group_sends_.replace_waiting(waiting.destination, former, id, image);
  return streams_.replace(waiting.destination, waiting.priority, former, id, image, now);
}

bool Engine::Implementation::replace_in_own_group(SendId former, SendId id, const Image& image, Time now) {
  const auto number = distributor_.replace(former, id, image, now);
  if (!number) return false;
  const Time lifetime = sendings_.at(id).lifetime;
  const multicast::HeldPacket packet{group_sends_.packet_of(former).stream, *number, image, now,
                                     lifetime > Time(0) ? now + lifetime : Time::max()};
  group_sends_.replace(former, id, packet);
  own_group_.replace_held(packet);
  return true;
}

void Engine::Implementation::expire_sends(Time now) {
  for (const SendId id : terms_.overdue(now)) cancel(id, now);
}

/// What of it is in the hands of the links still goes out.
void Engine::Implementation::cancel(SendId id, Time now) {
  const Sending sending = sendings_.at(id);
  std::string missed;
  if (sending.destination.empty()) {
    broadcasts_[static_cast<std::size_t>(sending.priority)].drop(id);
  } else if (multicast::root_of(sending.destination)) {
    missed = cancel_group_send(id, now);
  } else {
    streams_.drop(sending.destination, sending.priority, id, now);
  }
  finish(id, false, "not delivered" + missed + " within its lifetime of " + lifetime_text(sending.lifetime), now);
}

/// Tells which members it has not reached.
std::string Engine::Implementation::cancel_group_send(SendId id, Time now) {
  group_sends_.drop_waiting(sendings_.at(id).destination, id);
  group_sends_.drop(id);
  std::vector<std::string> missed;
  for (const MacAddress& member : distributor_.drop(id)) missed.push_back(name_or_address(member));
  std::vector<std::pair<SendId, Sending>> parts;
  for (const auto& item : sendings_) {
    if (item.second.purpose == Purpose::kFanOut && item.second.parent == id) parts.push_back(item);
  }
  for (const auto& [part, sending] : parts) {
    missed.push_back(sending.destination);
    streams_.drop(sending.destination, sending.priority, part, now);
    finish(part, false, {}, now);
  }
  std::string text;
  for (const std::string& member : missed) text += (text.empty() ? " to " : ", ") + member;
  return text;
}

}  // namespace adhoc_communication
