#include "node/relay_table.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace adhoc_communication {
namespace {

constexpr double kHighestRate = 1000.0;

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

void RelayTable::offer(Id id, Message message, Time) {
  const auto found = relays_.find(id);
  if (found == relays_.end()) return;
  Relay& relay = found->second;
  remember_last(relay, message);
  if (!present(relay.entry.destination)) {
    if (!relay.entry.latched) ++relay.dropped;
    return;
  }
  // A relay with a rate carries the newest message when its time has come; those in between are meant to be left out.
  const bool replaces =
      relay.entry.rate > 0.0 && !relay.waiting.empty() && relay.waiting.back().destination == relay.entry.destination;
  if (replaces) {
    octets_ -= relay.waiting.back().message->bytes.size();
    relay.waiting.pop_back();
  }
  enqueue(relay, {std::move(message), relay.entry.destination});
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
  if (!relay.entry.latched || !relay.last || relay.last->bytes.empty()) return;
  relay.due = std::min(relay.due, now);
  enqueue(relay, {relay.last, destination});
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
  for (auto& [id, relay] : relays_) {
    if (group_root(relay.entry.destination) != robot) continue;
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
  for (const std::string& member : members) {
    if (members_.count(member) != 0) continue;
    for (auto& [id, relay] : relays_) {
      if (relay.entry.destination == "mc_" + own_name_) enqueue_last(relay, member, now);
    }
  }
  members_ = {members.begin(), members.end()};
}

/// Apart from its rate.
bool RelayTable::ready(const Relay& relay) const {
  if (relay.waiting.empty() || relay.in_flight >= kMostInFlight) return false;
  const Waiting& first = relay.waiting.front();
  return teaching_.count({first.destination, type_of(*first.message)}) == 0;
}

std::optional<RelayTable::Transfer> RelayTable::next(Time now) {
  auto iterator = relays_.upper_bound(last_served_);
  for (std::size_t visited = 0; visited < relays_.size(); ++visited, ++iterator) {
    if (iterator == relays_.end()) iterator = relays_.begin();
    if (!ready(iterator->second) || iterator->second.due > now) continue;
    last_served_ = iterator->first;
    return start(iterator->first, iterator->second, now);
  }
  return std::nullopt;
}

RelayTable::Transfer RelayTable::start(Id id, Relay& relay, Time now) {
  Waiting waiting = std::move(relay.waiting.front());
  relay.waiting.pop_front();
  octets_ -= waiting.message->bytes.size();
  ++relay.in_flight;
  if (relay.entry.rate > 0.0) {
    relay.due = now + std::chrono::duration_cast<Time>(std::chrono::duration<double>(1.0 / relay.entry.rate));
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
  in_flight_.emplace(number, InFlight{id, std::move(waiting), teaches});
  return {number, std::move(request)};
}

void RelayTable::finished(std::uint64_t number, bool delivered, const std::string& reason, Time now) {
  const auto found = in_flight_.find(number);
  if (found == in_flight_.end()) return;
  const InFlight transfer = std::move(found->second);
  in_flight_.erase(found);
  const Lesson lesson(transfer.message.destination, type_of(*transfer.message.message));
  if (const auto teaching = teaching_.find(lesson); teaching != teaching_.end() && teaching->second == number) {
    teaching_.erase(teaching);
    if (known_.size() >= kMostKnown) known_.clear();
    if (delivered) known_.insert(lesson);
  }
  const auto relay = relays_.find(transfer.relay);
  if (relay == relays_.end()) return;
  --relay->second.in_flight;
  ++(delivered ? relay->second.delivered : relay->second.failed);
  if (delivered) return;
  relay->second.last_failure = reason;
  const bool still_the_last = relay->second.last == transfer.message.message;
  if (!relay->second.entry.latched || !still_the_last || !present(transfer.message.destination)) return;
  relay->second.due = std::max(relay->second.due, now + kRetry);
  enqueue(relay->second, transfer.message);
}

Time RelayTable::next_deadline() const {
  Time next = Time::max();
  for (const auto& [id, relay] : relays_) {
    if (ready(relay)) next = std::min(next, relay.due);
  }
  return next;
}

RelayTable::Message RelayTable::answer(const TypeName& type) const {
  for (const auto& [id, relay] : relays_) {
    if (relay.last && type_of(*relay.last) == type) return relay.last;
  }
  return nullptr;
}

}  // namespace adhoc_communication
