#include "delivery_invariants.hpp"

#include <algorithm>

#include "adhoc_communication/packet_size.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

using Kind = Action::Kind;

std::string about(const Action& action) { return "'" + describe(action) + "'"; }

}  // namespace

void DeliveryInvariants::crashed(std::size_t robot) {
  for (auto iterator = open_.begin(); iterator != open_.end();) {
    Packet& packet = packets_[iterator->second];
    packet.owed.erase(robot);
    if (packet.action.kind == Kind::kGroup && packet.action.other == robot) packet.owed.clear();
    iterator = packet.action.robot == robot ? open_.erase(iterator) : std::next(iterator);
  }
}

std::size_t DeliveryInvariants::add(const Action& action, Time now) {
  const std::size_t number = packets_.size();
  Packet packet;
  packet.action = action;
  packet.run = runs_[action.robot];
  if (action.kind == Kind::kGroup) packet.group = "mc_" + Team::name(action.other);
  packet.topic = "packet_" + std::to_string(number);
  packet.payload_type = static_cast<std::uint8_t>('A' + number % 26);
  // Every other packet can be compressed.
  packet.payload = noise(action.size, number + 1);
  if (number % 2 == 1) {
    for (std::size_t i = 1; i < packet.payload.size(); ++i) {
      if (i % 8 != 0) packet.payload[i] = packet.payload[i - 1];
    }
  }
  packet.sent = now;
  packets_.push_back(std::move(packet));
  return number;
}

SendRequest DeliveryInvariants::request(const Action& action, Time now) {
  Packet& packet = packets_[add(action, now)];
  std::string destination;
  if (action.kind == Kind::kUnicast) destination = Team::name(action.other);
  if (action.kind == Kind::kGroup) destination = packet.group;
  SendRequest request{destination, packet.topic, packet.payload_type, packet.payload, action.priority};
  packet.too_large = packet_size(request) > largest_packet_;
  return request;
}

BroadcastRequest DeliveryInvariants::flood(const Action& action, Time now) {
  const Packet& packet = packets_[add(action, now)];
  return {packet.topic, packet.payload_type, packet.payload, action.hops};
}

void DeliveryInvariants::accepted(SendId id, std::set<std::size_t> owed) {
  Packet& packet = packets_.back();
  packet.owed = std::move(owed);
  packet.owed.erase(packet.action.robot);
  const SendKey key{packet.action.robot, packet.run, id};
  if (!open_.emplace(key, packets_.size() - 1).second || over_.count(key) != 0) {
    throw Violation("send id " + std::to_string(id) + " was given twice");
  }
}

void DeliveryInvariants::received(std::size_t robot, const PacketReceived& received) {
  const auto found = std::find_if(packets_.begin(), packets_.end(),
                                  [&](const Packet& packet) { return packet.topic == received.topic; });
  if (found == packets_.end()) {
    throw Violation(Team::name(robot) + " received a packet with topic '" + received.topic + "' that nobody sent");
  }
  Packet& packet = *found;
  const std::string what = Team::name(robot) + " received " + about(packet.action);
  if (received.source != Team::name(packet.action.robot) || received.group != packet.group) {
    throw Violation(what + " as of " + received.source + " for group '" + received.group + "'");
  }
  if (received.payload != packet.payload || received.payload_type != packet.payload_type) {
    throw Violation(what + " altered");
  }
  check_addressee(robot, packet);
  if (!packet.received_by.emplace(robot, runs_[robot]).second) throw Violation(what + " twice");
  check_order(robot, packet, static_cast<std::size_t>(found - packets_.begin()));
  ++delivered_;
}

void DeliveryInvariants::check_addressee(std::size_t robot, const Packet& packet) const {
  const bool own = packet.action.robot == robot;
  const bool other = packet.action.kind == Kind::kUnicast && packet.action.other != robot;
  if (own || other) throw Violation(Team::name(robot) + " received " + about(packet.action) + ", not meant for it");
}

/// Only what is acknowledged keeps its order.
void DeliveryInvariants::check_order(std::size_t robot, const Packet& packet, std::size_t number) {
  const Action& action = packet.action;
  if (action.kind != Kind::kUnicast && action.kind != Kind::kGroup) return;
  const Stream stream{robot, runs_[robot], action.robot, packet.run, action.priority, packet.group};
  const auto [latest, first] = latest_.emplace(stream, number);
  if (!first && number < latest->second) {
    throw Violation(Team::name(robot) + " received " + about(action) + " after " +
                    about(packets_[latest->second].action) + ", which was sent later");
  }
  latest->second = number;
}

bool DeliveryInvariants::has(std::size_t robot, const Packet& packet) const {
  const auto found = packet.received_by.lower_bound({robot, 0});
  return found != packet.received_by.end() && found->first == robot;
}

void DeliveryInvariants::finished(std::size_t robot, const SendFinished& end, Time now) {
  const SendKey key{robot, runs_[robot], end.id};
  if (over_.count(key) != 0) {
    throw Violation("send " + std::to_string(end.id) + " of " + Team::name(robot) + " ended twice");
  }
  const auto found = open_.find(key);
  if (found == open_.end()) {
    throw Violation("send " + std::to_string(end.id) + " of " + Team::name(robot) + " ended, but was never made");
  }
  const Packet& packet = packets_[found->second];
  open_.erase(found);
  over_.insert(key);
  ended_at_[{robot, packet.action.priority}] = now;
  if (end.delivered != end.reason.empty()) {
    throw Violation(about(packet.action) + " ended with the contradiction delivered = " +
                    std::to_string(end.delivered) + ", reason '" + end.reason + "'");
  }
  const bool refused = end.reason.find("exceeds max_packet_size") != std::string::npos;
  if (packet.too_large != refused) {
    throw Violation(about(packet.action) + (refused ? " was refused as too large" : " is too large, but was taken"));
  }
  if (!end.delivered && packet.has_to_arrive) {
    throw Violation("A13.3: " + about(packet.action) + " failed, although there is a path: " + end.reason);
  }
  if (!end.delivered) return;
  if (packet.action.kind == Kind::kUnicast && !has(packet.action.other, packet)) {
    throw Violation(about(packet.action) + " is said to be delivered, but is not");
  }
  for (const std::size_t member : packet.owed) {
    if (has(member, packet)) continue;
    throw Violation(about(packet.action) + " is said to be delivered to all members, but " + Team::name(member) +
                    ", a member all the time, does not have it");
  }
}

void DeliveryInvariants::members(std::size_t root, const std::set<std::size_t>& members) {
  for (const auto& [key, number] : open_) {
    Packet& packet = packets_[number];
    if (packet.action.kind != Kind::kGroup || packet.action.other != root) continue;
    for (auto owed = packet.owed.begin(); owed != packet.owed.end();) {
      owed = *owed == root || members.count(*owed) != 0 ? std::next(owed) : packet.owed.erase(owed);
    }
  }
}

void DeliveryInvariants::left(std::size_t robot, std::size_t root) {
  for (const auto& [key, number] : open_) {
    Packet& packet = packets_[number];
    if (packet.action.kind == Kind::kGroup && packet.action.other == root) packet.owed.erase(robot);
  }
}

bool DeliveryInvariants::awaits_group(std::size_t root) const {
  return std::any_of(open_.begin(), open_.end(), [&](const auto& item) {
    const Action& action = packets_[item.second].action;
    return action.kind == Kind::kGroup && action.other == root;
  });
}

void DeliveryInvariants::check_patience(Time now) const {
  for (const auto& [key, number] : open_) {
    const Packet& packet = packets_[number];
    if (now < latest_end(packet)) continue;
    throw Violation(about(packet.action) + " has not ended after " + seconds_text(now - packet.sent));
  }
}

Time DeliveryInvariants::latest_end(const Packet& packet) const {
  if (hops_repeat_) return packet.sent + kPatience;
  const auto before = ended_at_.find({packet.action.robot, packet.action.priority});
  const Time first_in_line = before == ended_at_.end() ? packet.sent : std::max(packet.sent, before->second);
  return first_in_line + kPatience + static_cast<int>(1 + packet.action.size / kSmallestSegment) * kSilence;
}

}  // namespace adhoc_communication
