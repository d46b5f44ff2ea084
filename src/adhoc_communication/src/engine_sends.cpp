// Requests of the host, and how they end.
#include <algorithm>

#include "engine_implementation.hpp"
#include "texts.hpp"

namespace adhoc_communication {

using transport::Image;

std::string Engine::Implementation::refusal(const SendRequest& request) const {
  if (request.destination == self_.name) return "the destination " + request.destination + " is this robot itself";
  if (request.destination.size() > 255) return "the destination's name is longer than 255 octets";
  if (request.lifetime < Time(0)) return "the lifetime is negative";
  if (request.topic.empty()) return "the topic is empty";
  if (request.topic.size() > 65535) return "the topic is longer than 65535 octets";
  const std::size_t payload = std::max<std::size_t>(request.payload.size(), request.unpacked_size);
  std::size_t size = transport::image_size(request.destination, request.topic, payload);
  if (multicast::root_of(request.destination)) size += transport::image_size(request.destination, {}, 5);  // as a copy
  if (size > options_.max_packet_size) {
    return "packet of " + size_text(size) + " exceeds max_packet_size of " + size_text(options_.max_packet_size);
  }
  if (host_sends_ >= kMostSends) return "send queue is full (" + std::to_string(host_sends_) + " packets waiting)";
  if (octets_waiting_ + request.payload.size() > kMostSendOctets && host_sends_ > 0) {
    return "send queue is full (" + size_text(octets_waiting_) + " waiting, at most " + size_text(kMostSendOctets) +
           ")";
  }
  return {};
}

SendId Engine::Implementation::refuse(std::string reason) {
  const SendId id = next_send_id_++;
  ++statistics_.packets_failed;
  report(SendFinished{id, false, std::move(reason), false});
  return id;
}

SendId Engine::Implementation::send(SendRequest request, Time now) {
  touch(now);
  if (std::string reason = refusal(request); !reason.empty()) return refuse(std::move(reason));
  transport::Packet packet;
  packet.payload_type = request.payload_type;
  packet.topic = request.topic;
  packet.payload = std::move(request.payload);
  packet.latched = request.latched;
  packet.unpacked_size = request.unpacked_size;
  if (multicast::root_of(request.destination)) packet.group = request.destination;
  const Image image = transport::image_of(packet);
  const SendId id = next_send_id_++;
  sendings_[id] = {Purpose::kHost, request.destination, {}, 0, image->size(), {}, request.priority, request.lifetime};
  ++host_sends_;
  octets_waiting_ += image->size();
  if (request.lifetime > Time(0)) terms_.expire_at(id, now + request.lifetime);
  if (request.newest_only && takes_place(id, {request.destination, request.topic}, image, now)) return id;
  start(id, request.destination, image, request.priority, now);
  return id;
}

void Engine::Implementation::start(SendId id, const std::string& destination, const Image& image, Priority priority,
                                   Time now) {
  if (multicast::root_of(destination)) return start_group_send(id, destination, image, priority, now);
  if (!destination.empty()) return streams_.add(id, destination, image, priority, now);
  broadcasts_[static_cast<std::size_t>(priority)].add(id, image, static_cast<std::uint16_t>(broadcast_segment_size_));
}

SendId Engine::Implementation::broadcast(BroadcastRequest request, Time now) {
  touch(now);
  if (request.topic.empty()) return refuse("the topic is empty");
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
  const std::size_t most = segment_size_ + wire::kDataHeaderSize;
  if (body.size() > most) {
    return refuse("packet of " + std::to_string(body.size()) +
                  " octets does not fit the one frame of a flood, which takes " + std::to_string(most));
  }
  const SendId id = next_send_id_;
  if (!flood_.originate(id, std::move(body))) {
    return refuse(std::to_string(transport::FloodRelay::kMostWaiting) + " broadcasts wait for the air already");
  }
  ++next_send_id_;
  return id;
}

void Engine::Implementation::serve_floods(Time now) {
  flood_.poll(now);
  for (const SendId id : flood_.take_sent()) {
    ++statistics_.packets_sent;
    report(SendFinished{id, true, {}, false});
  }
}

SendId Engine::Implementation::start_unicast(const std::string& destination, Image image, Priority priority,
                                             Sending sending, Time now) {
  const SendId id = next_send_id_++;
  sending.priority = priority;
  sendings_.emplace(id, std::move(sending));
  streams_.add(id, destination, std::move(image), priority, now);
  return id;
}

void Engine::Implementation::start_group_send(SendId id, const std::string& group, Image image, Priority priority,
                                              Time now) {
  if (group == multicast::group_of(self_.name)) {
    return send_to_own_group(id, image, priority, now);
  }
  if (!memberships_.joined(group)) return finish(id, false, "this robot is not a member of " + group, now);
  const Time give_up = now + multicast::Memberships::kMembersPatience;
  if (group_sends_.wait(group, {id, std::move(image), priority, give_up})) request_members(group, now);
}

/// Along the tree, but for members that are being sent packets by themselves.
void Engine::Implementation::send_to_own_group(SendId id, const Image& image, Priority priority, Time now) {
  std::set<MacAddress> on_tree;
  std::vector<std::string> by_themselves;
  for (const std::string& name : own_group_.names()) {
    const auto address = directory_.address_of(name);
    if (!own_group_.served_by_copies(name) && address) {
      on_tree.insert(*address);
    } else {
      by_themselves.push_back(name);
    }
  }
  const std::uint32_t number = distributor_.start(id, priority, image, on_tree, now);
  const Time lifetime = sendings_.at(id).lifetime;
  const Time until = lifetime > Time(0) ? now + lifetime : Time::max();
  const multicast::HeldPacket packet{static_cast<std::uint8_t>(priority), number, image, now, until};
  own_group_.hold(packet, now);
  if (own_group_.size() == 0) return finish(id, true, {}, now);
  group_sends_.fan_out(id, own_group_.size(), packet);
  for (const std::string& name : by_themselves) send_copy(name, packet, Purpose::kFanOut, id, now);
}

void Engine::Implementation::fan_out(SendId id, const std::vector<std::string>& members, const Image& image,
                                     Priority priority, Time now) {
  if (members.empty()) return finish(id, true, {}, now);
  group_sends_.fan_out(id, members.size());
  for (const std::string& member : members) {
    start_unicast(member, image, priority, {Purpose::kFanOut, member, {}, id}, now);
  }
}

void Engine::Implementation::finish(SendId id, bool delivered, const std::string& reason, Time now, bool superseded) {
  const auto found = sendings_.find(id);
  if (found == sendings_.end()) return;
  const Sending sending = std::move(found->second);
  sendings_.erase(found);
  terms_.end(id);
  switch (sending.purpose) {
    case Purpose::kHost:
      --host_sends_;
      octets_waiting_ -= sending.octets;
      if (!superseded) ++(delivered ? statistics_.packets_sent : statistics_.packets_failed);
      return report(SendFinished{id, delivered, reason, superseded});
    case Purpose::kFanOut:
      copy_finished(sending);
      return finish_fan_out_part(sending.parent, sending.destination, delivered, reason, now);
    case Purpose::kCatchUp:
      return copy_finished(sending);
    case Purpose::kMembersRequest:
      if (!delivered) fail_waiting_sends(sending.group, reason, now);
      return;
    case Purpose::kWord:
      memberships_.said({sending.word, sending.group}, delivered, reason, now);
      return carry_out_memberships(now);
    case Purpose::kInternal:
      return;
  }
}

void Engine::Implementation::finish_fan_out_part(SendId parent, const std::string& member, bool delivered,
                                                 const std::string& reason, Time now) {
  const auto failures = group_sends_.part_finished(parent, member, delivered, reason);
  if (!failures) return;
  finish(parent, failures->empty(), failures->empty() ? "" : "not delivered to " + *failures, now);
}

std::vector<std::string> Engine::Implementation::neighbors() const {
  std::vector<std::string> names;
  for (const auto& [address, neighbor] : neighbors_.all()) {
    const routing::Robot* robot = directory_.find(address);
    if (robot != nullptr && robot->announced) names.push_back(robot->name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace adhoc_communication
