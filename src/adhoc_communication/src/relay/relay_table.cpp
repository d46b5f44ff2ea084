#include "relay/relay_table.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "adhoc_communication/packet_size.hpp"
#include "robot_name.hpp"

namespace adhoc_communication {
namespace {

constexpr double kHighestRate = 1000.0;
constexpr double kLongestLifetime = 86400.0;  ///< s

std::string group_root(const std::string& destination) {
  constexpr char kPrefix[] = "mc_";
  return destination.compare(0, 3, kPrefix) == 0 ? destination.substr(3) : destination;
}

bool same_relay(const RelayEntry& a, const RelayEntry& b) {
  return a.topic == b.topic && a.destination == b.destination && a.remote_topic == b.remote_topic;
}

}  // namespace

void RelayTable::check(const RelayEntry& entry) const {
  const std::string text = "relay of '" + entry.topic + "' to '" + entry.destination + "' ";
  if (entry.destination == own_name_) throw std::invalid_argument(text + "goes to this robot itself");
  if (!entry.destination.empty() && !is_robot_name(group_root(entry.destination))) {
    throw std::invalid_argument(text +
                                "names no robot or group (mc_<robot>): 1 to 64 letters, digits, '_', '-' or '.'");
  }
  if (!std::isfinite(entry.rate) || entry.rate < 0.0 || entry.rate > kHighestRate) {
    throw std::invalid_argument(text + "has a rate outside 0 .. 1000 messages per second");
  }
  if (!std::isfinite(entry.lifetime) || entry.lifetime < 0.0 || entry.lifetime > kLongestLifetime) {
    throw std::invalid_argument(text + "has a lifetime outside 0 .. 86400 s");
  }
  const bool exists = std::any_of(relays_.begin(), relays_.end(),
                                  [&entry](const auto& item) { return same_relay(item.second.entry(), entry); });
  if (exists) throw std::invalid_argument(text + "exists already: remove it first to change it");
  if (relays_.size() >= kMostRelays) {
    throw std::invalid_argument(text + "would be one more than the " + std::to_string(kMostRelays) + " allowed");
  }
}

RelayTable::Id RelayTable::add(RelayEntry entry) {
  check(entry);
  const Id id = next_id_++;
  relays_.try_emplace(id, std::move(entry), budget_);
  return id;
}

std::vector<RelayTable::Id> RelayTable::remove(const std::string& topic, const std::string& destination,
                                               const std::string& remote_topic) {
  std::vector<Id> removed;
  for (auto iterator = relays_.begin(); iterator != relays_.end();) {
    const RelayEntry& entry = iterator->second.entry();
    const bool meant = entry.topic == topic && entry.destination == destination &&
                       (remote_topic.empty() || entry.remote_topic == remote_topic);
    if (meant) removed.push_back(iterator->first);
    iterator = meant ? relays_.erase(iterator) : std::next(iterator);
  }
  return removed;
}

std::vector<RelayReport> RelayTable::reports() const {
  std::vector<RelayReport> reports;
  for (const auto& [id, relay] : relays_) reports.push_back(relay.report());
  return reports;
}

bool RelayTable::present(const std::string& destination) const {
  const std::string root = group_root(destination);
  return destination.empty() || root == own_name_ || robots_.count(root) != 0;
}

/// Where it is not being taught the definition.
RelayQueue::MaySend RelayTable::may_send() const {
  return [this](const std::string& destination, const TypeName& type) {
    return present(destination) && !lessons_.under_way(destination, type);
  };
}

void RelayTable::offer(Id id, Message message, Time now) {
  const auto found = relays_.find(id);
  if (found == relays_.end()) return;
  found->second.offer(std::move(message), present(found->second.entry().destination), now);
}

void RelayTable::robot_appeared(const std::string& robot, Time now) {
  lessons_.forget(robot);
  robots_.insert(robot);
  for (auto& [id, relay] : relays_) {
    if (group_root(relay.entry().destination) == robot) relay.owe_last(relay.entry().destination, now);
  }
}

void RelayTable::robot_lost(const std::string& robot) {
  lessons_.forget(robot);
  robots_.erase(robot);
  members_.erase(robot);
  news_.lost(robot);
  for (auto& [id, relay] : relays_) {
    if (group_root(relay.entry().destination) == robot) relay.destination_lost();
    relay.member_lost(robot);
  }
}

void RelayTable::group_members(const std::vector<std::string>& members, Time now) {
  const std::set<std::string> present(members.begin(), members.end());
  for (const std::string& member : members_) {
    if (present.count(member) != 0) continue;
    news_.left(member);
    for (auto& [id, relay] : relays_) {
      if (relay.entry().destination == own_group_) relay.member_left(member);
    }
  }
  for (const std::string& member : present) {
    if (members_.count(member) != 0) continue;
    news_.joined(member, now);
    owe(own_group_, member, now);
  }
  members_ = present;
}

void RelayTable::group_packet(const PacketReceived& packet) {
  if (packet.group == own_group_) news_.heard(packet);
}

void RelayTable::new_member(const PacketReceived& word, Time now) {
  const std::string member = GroupNews::member_in(word);
  if (member != own_name_) owe("mc_" + word.source, member, now);
}

void RelayTable::owe(const std::string& group, const std::string& member, Time now) {
  for (auto& [id, relay] : relays_) {
    if (relay.entry().destination == group) relay.owe_last(member, now);
  }
}

std::optional<RelayTable::Transfer> RelayTable::next(Time now) {
  if (auto letter = letters_.next(next_number_)) return Transfer{next_number_++, std::move(*letter)};
  if (auto word = news_.next(next_number_, now)) return Transfer{next_number_++, std::move(*word)};
  auto iterator = relays_.upper_bound(last_served_);
  for (std::size_t visited = 0; visited < relays_.size(); ++visited, ++iterator) {
    if (iterator == relays_.end()) iterator = relays_.begin();
    RelayQueue& relay = iterator->second;
    relay.drop_expired(now);
    if (!relay.ready(may_send()) || relay.due() > now) continue;
    last_served_ = iterator->first;
    return start(iterator->first, relay, now);
  }
  return std::nullopt;
}

RelayTable::Transfer RelayTable::start(Id id, RelayQueue& relay, Time now) {
  const RelayTransfer transfer = relay.take(may_send(), now);
  const RelayEntry& entry = relay.entry();
  const std::uint64_t number = next_number_++;
  const TypeName carried = type_of(*transfer.message);
  // Some publishers give no definition: nobody who asks for it later could be answered.
  const bool teaches = !transfer.message->definition.empty();
  const bool knows = teaches && lessons_.known(transfer.destination, carried);
  // Nobody answers for a broadcast.
  if (teaches && !knows && !transfer.destination.empty()) lessons_.begin(transfer.destination, carried, number);
  const PayloadType type = knows ? PayloadType::kMessageByType : PayloadType::kAnyMessage;
  SendRequest request;
  request.destination = transfer.destination;
  request.topic = entry.remote_topic.empty() ? entry.topic : entry.remote_topic;
  request.payload_type = static_cast<std::uint8_t>(type);
  request.payload = knows ? encode_message_by_type(*transfer.message) : encode_any_message(*transfer.message);
  request.priority = entry.priority;
  request.latched = entry.latched || transfer.message->latched;
  request.newest_only = entry.newest_only;
  if (transfer.expires != Time::max()) request.lifetime = transfer.expires - now;
  const bool is_too_large = packet_size(request) > max_packet_size_;
  in_flight_.emplace(number, InFlight{id, {transfer.message, carried, transfer.destination, is_too_large}});
  return {number, std::move(request)};
}

std::optional<RelayTable::InFlight> RelayTable::end_transfer(std::uint64_t number, bool delivered) {
  const auto found = in_flight_.find(number);
  if (found == in_flight_.end()) return std::nullopt;
  InFlight ended = std::move(found->second);
  in_flight_.erase(found);
  lessons_.end(ended.message.destination, ended.message.type, number, delivered);
  const auto relay = relays_.find(ended.relay);
  if (relay == relays_.end()) return std::nullopt;
  relay->second.ended();
  return ended;
}

void RelayTable::superseded(std::uint64_t number) { end_transfer(number, false); }

void RelayTable::finished(std::uint64_t number, bool delivered, const std::string& reason, Time now,
                          const std::vector<std::string>& missed) {
  if (letters_.ended(number) || news_.ended(number, delivered, now)) return;
  const std::optional<InFlight> ended = end_transfer(number, delivered);
  if (!ended) return;
  RelayQueue& relay = relays_.at(ended->relay);
  relay.finished(ended->message, delivered, reason, present(relay.entry().destination), now, missed);
}

Time RelayTable::next_deadline() const {
  Time next = letters_.ready() ? Time::zero() : news_.next_deadline();
  for (const auto& [id, relay] : relays_) {
    if (relay.ready(may_send())) next = std::min(next, relay.due());
  }
  return next;
}

void RelayTable::answer(const PacketReceived& request) {
  const SerializedMessage asked = decode_any_message(request);
  const TypeName type = type_of(asked);
  for (const auto& [id, relay] : relays_) {
    if (!relay.last() || relay.last()->definition.empty() || !(type_of(*relay.last()) == type)) continue;
    return letters_.answer(request.source, type, relay.last()->definition);
  }
}

}  // namespace adhoc_communication
