#include "relay/relay_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace adhoc_communication {
namespace {

constexpr double kHighestRate = 1000.0;
constexpr double kLongestLifetime = 86400.0;  ///< s

Time seconds(double count) { return std::chrono::duration_cast<Time>(std::chrono::duration<double>(count)); }

std::string group_root(const std::string& destination) {
  constexpr char kPrefix[] = "mc_";
  return destination.compare(0, 3, kPrefix) == 0 ? destination.substr(3) : destination;
}

TypeName type_of(const SerializedMessage& message) { return {message.type, message.md5sum}; }

bool same_relay(const RelayEntry& a, const RelayEntry& b) {
  return a.topic == b.topic && a.destination == b.destination && a.remote_topic == b.remote_topic;
}

}  // namespace

void RelayTable::check(const RelayEntry& entry) const {
  const std::string text = "relay of '" + entry.topic + "' to '" + entry.destination + "' ";
  if (entry.destination == own_name_) throw std::invalid_argument(text + "goes to this robot itself");
  if (!std::isfinite(entry.rate) || entry.rate < 0.0 || entry.rate > kHighestRate) {
    throw std::invalid_argument(text + "has a rate outside 0 .. 1000 messages per second");
  }
  if (!std::isfinite(entry.lifetime) || entry.lifetime < 0.0 || entry.lifetime > kLongestLifetime) {
    throw std::invalid_argument(text + "has a lifetime outside 0 .. 86400 s");
  }
  const bool exists = std::any_of(relays_.begin(), relays_.end(),
                                  [&entry](const auto& item) { return same_relay(item.second.entry, entry); });
  if (exists) throw std::invalid_argument(text + "exists already: remove it first to change it");
  if (relays_.size() >= kMostRelays) {
    throw std::invalid_argument(text + "would be one more than the " + std::to_string(kMostRelays) + " allowed");
  }
}

RelayTable::Id RelayTable::add(RelayEntry entry) {
  check(entry);
  const Id id = next_id_++;
  relays_[id].entry = std::move(entry);
  return id;
}

std::vector<RelayTable::Id> RelayTable::remove(const std::string& topic, const std::string& destination,
                                               const std::string& remote_topic) {
  std::vector<Id> removed;
  for (auto iterator = relays_.begin(); iterator != relays_.end();) {
    Relay& relay = iterator->second;
    const RelayEntry& entry = relay.entry;
    const bool meant = entry.topic == topic && entry.destination == destination &&
                       (remote_topic.empty() || entry.remote_topic == remote_topic);
    if (!meant) {
      ++iterator;
      continue;
    }
    while (!relay.waiting.empty()) drop_oldest(relay);
    remember_last(relay, nullptr);
    removed.push_back(iterator->first);
    iterator = relays_.erase(iterator);
  }
  return removed;
}

std::vector<RelayReport> RelayTable::reports() const {
  std::vector<RelayReport> reports;
  for (const auto& [id, relay] : relays_) {
    RelayReport report;
    report.entry = relay.entry;
    if (relay.last) report.type = relay.last->type;
    report.waiting = relay.waiting.size();
    for (const Waiting& waiting : relay.waiting) report.octets += waiting.message->bytes.size();
    report.delivered = relay.delivered;
    report.dropped = relay.dropped;
    report.failed = relay.failed;
    report.last_failure = relay.last_failure;
    reports.push_back(std::move(report));
  }
  return reports;
}

bool RelayTable::present(const std::string& destination) const {
  const std::string root = group_root(destination);
  return destination.empty() || root == own_name_ || robots_.count(root) != 0;
}

void RelayTable::offer(Id id, Message message, Time now) {
  const auto found = relays_.find(id);
  if (found == relays_.end()) return;
  Relay& relay = found->second;
  remember_last(relay, message);
  relay.last_expires = relay.entry.lifetime > 0.0 ? now + seconds(relay.entry.lifetime) : Time::max();
  relay.owed.clear();  // they belong to the destination by now
  if (!present(relay.entry.destination)) {
    if (!relay.entry.latched) ++relay.dropped;
    return;
  }
  // A relay with a rate carries the newest message when its time has come; those in between are meant to be left out.
  const bool replaces = (relay.entry.rate > 0.0 || relay.entry.newest_only) && !relay.waiting.empty();
  if (replaces) {
    octets_ -= relay.waiting.back().message->bytes.size();
    relay.waiting.pop_back();
  }
  enqueue(relay, {std::move(message), relay.entry.destination, relay.last_expires});
}

/// Only a latched message keeps its octets; of the others the type is kept, to answer who lacks the definition.
void RelayTable::remember_last(Relay& relay, Message message) {
  if (relay.last) octets_ -= relay.last->bytes.size();
  const bool without_octets = message && (!relay.entry.latched || octets_ + message->bytes.size() > kMostOctets);
  if (!without_octets) {
    relay.last = std::move(message);
  } else if (!relay.last || !relay.last->bytes.empty() || type_of(*relay.last) < type_of(*message) ||
             type_of(*message) < type_of(*relay.last)) {
    relay.last =
        std::make_shared<SerializedMessage>(SerializedMessage{message->type, message->md5sum, message->definition, {}});
  }
  if (relay.last) octets_ += relay.last->bytes.size();
}

void RelayTable::drop_oldest(Relay& relay) {
  octets_ -= relay.waiting.front().message->bytes.size();
  relay.waiting.pop_front();
  ++relay.dropped;
}

bool RelayTable::make_room(Relay& relay, std::size_t octets) {
  while (!relay.waiting.empty() && (relay.waiting.size() >= kMostWaiting || octets_ + octets > kMostOctets)) {
    drop_oldest(relay);
  }
  return octets_ + octets <= kMostOctets;
}

void RelayTable::enqueue(Relay& relay, Waiting message) {
  const std::size_t octets = message.message->bytes.size();
  if (!make_room(relay, octets)) {
    ++relay.dropped;
    return;
  }
  octets_ += octets;
  relay.waiting.push_back(std::move(message));
}

void RelayTable::enqueue_last(Relay& relay, const std::string& destination, Time now) {
  if (!relay.entry.latched || !relay.last || relay.last->bytes.empty() || relay.last_expires <= now) return;
  relay.due = std::min(relay.due, now);
  if (destination == relay.entry.destination) {
    enqueue(relay, {relay.last, destination, relay.last_expires});
  } else if (relay.owed.size() < kMostOwed) {
    relay.owed.insert(destination);
  }
}

void RelayTable::robot_appeared(const std::string& robot, Time now) {
  forget(robot);
  robots_.insert(robot);
  for (auto& [id, relay] : relays_) {
    if (group_root(relay.entry.destination) == robot) enqueue_last(relay, relay.entry.destination, now);
  }
}

void RelayTable::robot_lost(const std::string& robot) {
  forget(robot);
  robots_.erase(robot);
  members_.erase(robot);
  news_.lost(robot);
  for (auto& [id, relay] : relays_) {
    if (group_root(relay.entry.destination) != robot) continue;
    relay.owed.clear();
    while (!relay.waiting.empty()) drop_oldest(relay);
  }
}

/// What the robot knew is gone with its run; a definition on its way proves nothing any more.
void RelayTable::forget(const std::string& destination) {
  const auto concerns = [&destination](const Lesson& lesson) { return lesson.first == destination; };
  for (auto known = known_.begin(); known != known_.end();) {
    known = concerns(*known) ? known_.erase(known) : std::next(known);
  }
  for (auto lesson = teaching_.begin(); lesson != teaching_.end();) {
    lesson = concerns(lesson->first) ? teaching_.erase(lesson) : std::next(lesson);
  }
}

void RelayTable::group_members(const std::vector<std::string>& members, Time now) {
  const std::set<std::string> present(members.begin(), members.end());
  for (const std::string& member : members_) {
    if (present.count(member) != 0) continue;
    news_.left(member);
    for (auto& [id, relay] : relays_) {
      if (relay.entry.destination == own_group_) relay.owed.erase(member);
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
    if (relay.entry.destination == group) enqueue_last(relay, member, now);
  }
}

/// Apart from its rate.
bool RelayTable::ready(const Relay& relay) const {
  if (relay.in_flight >= kMostInFlight) return false;
  if (!relay.waiting.empty()) return !teaches(relay.waiting.front().destination, relay.waiting.front().message);
  return next_owed(relay) != relay.owed.end();
}

/// Who is there, and is not being taught the definition.
std::set<std::string>::iterator RelayTable::next_owed(const Relay& relay) const {
  return std::find_if(relay.owed.begin(), relay.owed.end(), [&](const std::string& destination) {
    return present(destination) && !teaches(destination, relay.last);
  });
}

/// A definition of that type is on its way there.
bool RelayTable::teaches(const std::string& destination, const Message& message) const {
  return teaching_.count({destination, type_of(*message)}) != 0;
}

void RelayTable::drop_expired(Relay& relay, Time now) {
  while (!relay.waiting.empty() && relay.waiting.front().expires <= now) drop_oldest(relay);
  if (relay.last_expires <= now) relay.owed.clear();
}

/// ready() holds.
RelayTable::Waiting RelayTable::take_first(Relay& relay) {
  if (relay.waiting.empty()) {
    const auto owed = next_owed(relay);
    Waiting first{relay.last, *owed, relay.last_expires};
    relay.owed.erase(owed);
    return first;
  }
  Waiting first = std::move(relay.waiting.front());
  relay.waiting.pop_front();
  octets_ -= first.message->bytes.size();
  return first;
}

std::optional<RelayTable::Transfer> RelayTable::next(Time now) {
  if (auto letter = letters_.next(next_number_)) return Transfer{next_number_++, std::move(*letter)};
  if (auto word = news_.next(next_number_, now)) return Transfer{next_number_++, std::move(*word)};
  auto iterator = relays_.upper_bound(last_served_);
  for (std::size_t visited = 0; visited < relays_.size(); ++visited, ++iterator) {
    if (iterator == relays_.end()) iterator = relays_.begin();
    drop_expired(iterator->second, now);
    if (!ready(iterator->second) || iterator->second.due > now) continue;
    last_served_ = iterator->first;
    return start(iterator->first, iterator->second, now);
  }
  return std::nullopt;
}

RelayTable::Transfer RelayTable::start(Id id, Relay& relay, Time now) {
  Waiting waiting = take_first(relay);
  ++relay.in_flight;
  if (relay.entry.rate > 0.0 && waiting.destination == relay.entry.destination) {
    relay.due = now + seconds(1.0 / relay.entry.rate);
  }
  const std::uint64_t number = next_number_++;
  const Lesson lesson(waiting.destination, type_of(*waiting.message));
  const bool knows = known_.count(lesson) != 0;
  const bool teaches = !knows && !waiting.destination.empty();  // nobody answers for a broadcast
  if (teaches) teaching_[lesson] = number;
  const PayloadType type = knows ? PayloadType::kMessageByType : PayloadType::kAnyMessage;
  SendRequest request;
  request.destination = waiting.destination;
  request.topic = relay.entry.remote_topic.empty() ? relay.entry.topic : relay.entry.remote_topic;
  request.payload_type = static_cast<std::uint8_t>(type);
  request.payload = knows ? encode_message_by_type(*waiting.message) : encode_any_message(*waiting.message);
  request.priority = relay.entry.priority;
  request.latched = relay.entry.latched || waiting.message->latched;
  request.newest_only = relay.entry.newest_only;
  if (waiting.expires != Time::max()) request.lifetime = waiting.expires - now;
  in_flight_.emplace(number, InFlight{id, std::move(waiting), teaches});
  return {number, std::move(request)};
}

std::optional<RelayTable::InFlight> RelayTable::end_transfer(std::uint64_t number, bool delivered) {
  const auto found = in_flight_.find(number);
  if (found == in_flight_.end()) return std::nullopt;
  InFlight transfer = std::move(found->second);
  in_flight_.erase(found);
  const Lesson lesson(transfer.message.destination, type_of(*transfer.message.message));
  if (const auto teaching = teaching_.find(lesson); teaching != teaching_.end() && teaching->second == number) {
    teaching_.erase(teaching);
    if (known_.size() >= kMostKnown) known_.clear();
    if (delivered) known_.insert(lesson);
  }
  const auto relay = relays_.find(transfer.relay);
  if (relay == relays_.end()) return std::nullopt;
  --relay->second.in_flight;
  return transfer;
}

void RelayTable::superseded(std::uint64_t number) { end_transfer(number, false); }

void RelayTable::finished(std::uint64_t number, bool delivered, const std::string& reason, Time now) {
  if (letters_.ended(number) || news_.ended(number, delivered, now)) return;
  const std::optional<InFlight> transfer = end_transfer(number, delivered);
  if (!transfer) return;
  Relay& relay = relays_.at(transfer->relay);
  ++(delivered ? relay.delivered : relay.failed);
  if (delivered) return;
  relay.last_failure = reason;
  const bool still_the_last = relay.last == transfer->message.message;
  const bool owed = transfer->message.destination != relay.entry.destination;  // by itself, also after it was away
  if (!still_the_last || (!owed && !present(relay.entry.destination))) return;
  const Time due = std::max(relay.due, now + kRetry);
  enqueue_last(relay, transfer->message.destination, now);
  relay.due = due;
}

Time RelayTable::next_deadline() const {
  Time next = letters_.ready() ? Time::zero() : news_.next_deadline();
  for (const auto& [id, relay] : relays_) {
    if (ready(relay)) next = std::min(next, relay.due);
  }
  return next;
}

void RelayTable::answer(const PacketReceived& request) {
  const SerializedMessage asked = decode_any_message(request);
  const TypeName type = type_of(asked);
  for (const auto& [id, relay] : relays_) {
    if (!relay.last || !(type_of(*relay.last) == type)) continue;
    return letters_.answer(request.source, type, relay.last->definition);
  }
}

}  // namespace adhoc_communication
