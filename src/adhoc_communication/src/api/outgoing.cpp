#include "api/outgoing.hpp"

#include <cstdio>

namespace adhoc_communication {

using transport::Image;
using transport::Purpose;
using transport::Sending;

namespace {

/// `missed`: which members of a group it has not reached.
std::string not_delivered(const std::string& missed, Time lifetime) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g s", static_cast<double>(lifetime.count()) * 1e-9);
  return "not delivered" + missed + " within its lifetime of " + text;
}

}  // namespace

SendId Outgoing::refuse(std::string reason) {
  const SendId id = sends_.take_id();
  ++statistics_.packets_failed;
  events_.add(SendFinished{id, false, std::move(reason), false});
  return id;
}

SendId Outgoing::send(SendRequest request, Time now) {
  if (std::string reason = sends_.refusal(request); !reason.empty()) return refuse(std::move(reason));
  transport::Packet packet;
  packet.payload_type = request.payload_type;
  packet.topic = request.topic;
  packet.payload = std::move(request.payload);
  packet.latched = request.latched;
  packet.unpacked_size = request.unpacked_size;
  if (multicast::root_of(request.destination)) packet.group = request.destination;
  const Image image = transport::image_of(packet);
  Sending sending{Purpose::kHost, request.destination};
  sending.octets = image->size();
  sending.priority = request.priority;
  sending.lifetime = request.lifetime;
  const SendId id = sends_.begin(std::move(sending), now);
  if (!request.newest_only || !take_place(id, request.topic, image, now)) start(id, image, now);
  return id;
}

void Outgoing::start(SendId id, const Image& image, Time now) {
  const Sending& sending = sends_.at(id);
  if (multicast::root_of(sending.destination) && sending.purpose == Purpose::kHost) {
    groups_.send(id, sending.destination, image, sending.priority, sending.lifetime, now);
    settle(now);
  } else if (!sending.destination.empty()) {
    streams_.add(id, sending.destination, image, sending.priority, now);
  } else {
    broadcasts_[static_cast<std::size_t>(sending.priority)].add(id, image, segment_size_);
  }
}

/// True when the packet has got the place of the former one of its subject in whatever queue that waits.
bool Outgoing::take_place(SendId id, const std::string& topic, const Image& image, Time now) {
  const auto former = sends_.make_newest(id, topic);
  if (!former || !replace(*former, id, image, now)) return false;
  finish(*former, false, "a newer packet for topic '" + topic + "' has taken its place", now, true);
  return true;
}

bool Outgoing::replace(SendId former, SendId id, const Image& image, Time now) {
  const Sending& waiting = sends_.at(former);
  const Sending& next = sends_.at(id);
  if (waiting.priority != next.priority) return false;
  if (waiting.destination.empty()) {
    return broadcasts_[static_cast<std::size_t>(next.priority)].replace(former, id, image, segment_size_);
  }
  if (multicast::root_of(waiting.destination)) {
    return groups_.replace(former, id, waiting.destination, image, next.lifetime, now);
  }
  return streams_.replace(waiting.destination, waiting.priority, former, id, image, now);
}

SendId Outgoing::broadcast(BroadcastRequest request, Time now) {
  if (request.topic.empty()) return refuse("the topic is empty");
  if (request.lifetime < Time(0)) return refuse("the lifetime is negative");
  if (request.unpacked_size > transport::FloodRelay::kMostUnpacked) {
    return refuse("packet of " + std::to_string(request.unpacked_size) +
                  " octets is more than a flood may unpack to, which is " +
                  std::to_string(transport::FloodRelay::kMostUnpacked));
  }
  wire::Flood flood;
  flood.source = self_.address;
  flood.source_boot = self_.boot;
  flood.id = next_flood_id_++;
  flood.hop_limit = std::max<std::uint8_t>(1, request.hop_limit);
  flood.source_name = self_.name;
  flood.image = *transport::image_of({transport::PacketKind::kUser,
                                      request.payload_type,
                                      {},
                                      request.topic,
                                      std::move(request.payload),
                                      request.latched,
                                      request.unpacked_size});
  Bytes body = to_bytes(flood);
  if (body.size() > longest_flood_) {
    return refuse("packet of " + std::to_string(body.size()) +
                  " octets does not fit the one frame of a flood, which takes " + std::to_string(longest_flood_));
  }
  if (!floods_.originate(sends_.next_id(), std::move(body), request.lifetime, now)) {
    return refuse(std::to_string(transport::FloodRelay::kMostWaiting) + " broadcasts wait for the air already");
  }
  return sends_.take_id();
}

void Outgoing::settle_floods() {
  for (const SendId id : floods_.take_sent()) {
    ++statistics_.packets_sent;
    events_.add(SendFinished{id, true, {}, false});
  }
  for (const auto& [id, lifetime] : floods_.take_overdue()) {
    ++statistics_.packets_failed;
    events_.add(SendFinished{id, false, not_delivered({}, lifetime), false});
  }
}

void Outgoing::finish(SendId id, bool delivered, const std::string& reason, Time now, bool superseded) {
  const std::optional<Sending> sending = sends_.end(id);
  if (!sending) return;
  if (sending->purpose != Purpose::kHost) {
    groups_.ended(*sending, delivered, reason, now);
    return settle(now);
  }
  if (!superseded) ++(delivered ? statistics_.packets_sent : statistics_.packets_failed);
  events_.add(SendFinished{id, delivered, reason, superseded});
}

void Outgoing::finish(const multicast::GroupSendEnd& end) {
  if (!sends_.end(end.id)) return;
  ++(end.delivered ? statistics_.packets_sent : statistics_.packets_failed);
  events_.add(SendFinished{end.id, end.delivered, end.reason, false, end.missed});
}

void Outgoing::expire(Time now) {
  for (const SendId id : sends_.overdue(now)) cancel(id, now);
}

/// What of it is in the hands of the hops still goes out.
void Outgoing::cancel(SendId id, Time now) {
  const Sending sending = sends_.at(id);
  std::string missed;
  if (sending.destination.empty()) {
    broadcasts_[static_cast<std::size_t>(sending.priority)].drop(id);
  } else if (multicast::root_of(sending.destination)) {
    missed = cancel_group_send(id, now);
  } else {
    streams_.drop(sending.destination, sending.priority, id, now);
  }
  finish(id, false, not_delivered(missed, sending.lifetime), now);
}

/// Tells which members it has not reached.
std::string Outgoing::cancel_group_send(SendId id, Time now) {
  std::vector<std::string> missed = groups_.cancel(id, sends_.at(id).destination);
  for (const SendId part : sends_.parts_of(id)) {
    const Sending sending = sends_.at(part);
    missed.push_back(sending.destination);
    streams_.drop(sending.destination, sending.priority, part, now);
    finish(part, false, {}, now);
  }
  std::string text;
  for (const std::string& member : missed) text += (text.empty() ? " to " : ", ") + member;
  return text;
}

void Outgoing::join(const std::string& group, Time now) {
  groups_.join(group);
  settle(now);
}

void Outgoing::leave(const std::string& group, Time now) {
  groups_.leave(group);
  settle(now);
}

void Outgoing::settle(Time now) {
  for (multicast::Letter& letter : groups_.take_letters()) {
    start(sends_.begin(std::move(letter.sending), now), letter.image, now);
  }
  for (const multicast::GroupSendEnd& end : groups_.take_ends()) finish(end);
  for (GroupChangeFinished& change : groups_.take_changes()) events_.add(std::move(change));
}

void Outgoing::end(const std::string& reason, Time now) {
  while (const auto id = sends_.first()) finish(*id, false, reason, now);
  for (const SendId id : floods_.take_waiting()) events_.add(SendFinished{id, false, reason, false});
  groups_.end(reason);
  settle(now);
}

}  // namespace adhoc_communication
