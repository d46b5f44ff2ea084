#include "relay/inbox.hpp"

#include <exception>
#include <utility>

#include "adhoc_communication/compression.hpp"
#include "relay/definition_md5.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMostWord = 64'000;  ///< octets of what robots say to one another about types and members

PayloadType type_of(const PacketReceived& packet) { return static_cast<PayloadType>(packet.payload_type); }

}  // namespace

Inbox::Inbox(LocalTopics& local, TopicFilter filter, InboxCalls calls)
    : local_(local), others_(local), filter_(std::move(filter)), calls_(std::move(calls)) {}

void Inbox::take(PacketReceived packet, Time now) {
  process(std::move(packet), now);
  settle(now);
}

void Inbox::release(Time now) {
  definitions_.expire(now);
  for (const auto& [robot, type] : definitions_.take_overdue(now)) calls_.ask(robot, type);
  topics_.release_all(now);
  settle(now);
}

void Inbox::process(PacketReceived packet, Time now) {
  try {
    carry_out(packet, now);
  } catch (const std::exception& error) {
    drop(packet, error.what());
  }
}

/// What has waited for an answer goes on, whatever that was.
void Inbox::settle(Time now) {
  if (others_.settle(now)) {
    PacketQueue held = std::exchange(held_, {});
    while (!held.empty()) process(held.take(), now);
  }
  tell_of_slow_subscribers();
  tell_of_topics_given_up();
  tell_of_topics_refused();
}

void Inbox::carry_out(PacketReceived& packet, Time now) {
  const bool asks = type_of(packet) == PayloadType::kDefinitionRequest;
  const bool is_word = asks || type_of(packet) == PayloadType::kNewMember;
  const bool is_definition = type_of(packet) == PayloadType::kDefinition;
  definitions_.expire(now);
  // Before it takes time and memory: it may unpack to a thousand times as much.
  if (is_definition && !definitions_.awaits_any()) return;
  if (is_word && packet.unpacked_size > kMostWord) throw PayloadError("it is too large for what it is to say");
  if (!is_word && !is_definition && !may_be_unpacked(packet, now)) return hold(packet);
  if (!unpack(packet)) throw PayloadError("it is not what it says that it unpacks to");
  if (is_word) return asks ? calls_.answer(packet) : calls_.new_member(packet);
  SerializedMessage message = calls_.decode(packet);
  // Unasked definitions are not kept: nobody can fill the memory with them.
  if (is_definition && definitions_.awaits({message.type, message.md5sum})) {
    learn_definition(message, packet.source, now);
  }
  if (is_definition || !complete(message, packet, now)) return;
  // While it has waited for its definition own nodes may have begun to publish its topic.
  if (!check_topic(local_.full_name(packet.topic), now)) return hold(packet);
  packet.payload = {};  // large ones are not to be in memory twice
  publish(packet, std::move(message), now);
}

/// False when it has to be learned first who uses its topic. Not so if others of that topic wait for their definition:
/// it is not to overtake them, nor they it.
bool Inbox::may_be_unpacked(const PacketReceived& packet, Time now) {
  const std::string topic = local_.full_name(packet.topic);
  const auto is_of_topic = [&](const PacketReceived& other) { return local_.full_name(other.topic) == topic; };
  if (!topics_.knows(topic) && filter_.admits(topic) && definitions_.holds(is_of_topic)) return true;
  return check_topic(topic, now);
}

/// False when it has to be learned first who uses that topic.
bool Inbox::check_topic(const std::string& topic, Time now) {
  if (!filter_.admits(topic)) {
    throw PayloadError("other robots may not publish '" + topic + "' here (parameters inject_allow, inject_deny)");
  }
  if (!topics_.knows(topic)) {
    if (!held_.empty()) return false;  // some of the same topic may be among them
    return filter_.names(topic) ? others_.knows_subscribers(now) : others_.check_new(topic, now);
  }
  if (filter_.names(topic)) return true;
  try {
    others_.check_carried(topic, now);
  } catch (const PayloadError&) {
    topics_.forget(topic);
    throw;
  }
  return true;
}

void Inbox::hold(PacketReceived& packet) {
  for (const PacketReceived& dropped : held_.add(std::move(packet))) {
    drop(dropped, "too many packets wait for the ROS master, which is asked who uses their topics here");
  }
}

/// The MD5 sum is what subscribers and other senders go by, so it has to be that of the definition.
void Inbox::learn_definition(const SerializedMessage& message, const std::string& source, Time now) {
  if (md5_of_definition(message.type, message.definition) != message.md5sum) {
    throw PayloadError("the definition of " + message.type + " does not have the MD5 sum " + message.md5sum);
  }
  for (PacketReceived& waited : definitions_.learn({message.type, message.md5sum}, message.definition, source)) {
    process(std::move(waited), now);
  }
}

/// False when the message has to wait for its definition.
bool Inbox::complete(SerializedMessage& message, PacketReceived& packet, Time now) {
  const TypeName type{message.type, message.md5sum};
  if (type_of(packet) == PayloadType::kAnyMessage) {
    const std::string* known = definitions_.find(type);
    if (known == nullptr && !message.definition.empty()) learn_definition(message, packet.source, now);
    if (known != nullptr) message.definition = *known;
    return true;
  }
  if (type_of(packet) != PayloadType::kMessageByType) return true;
  if (const std::string* definition = definitions_.find(type)) {
    message.definition = *definition;
    return true;
  }
  const std::string source = packet.source;
  message.bytes = {};
  if (definitions_.hold(std::move(packet), type, now)) calls_.ask(source, type);
  return false;
}

void Inbox::publish(const PacketReceived& packet, SerializedMessage message, Time now) {
  TopicTable::Topic& topic = topic_for(local_.full_name(packet.topic), message, packet, now);
  topics_.publish(topic, std::move(message), now);
}

TopicTable::Topic& Inbox::topic_for(const std::string& name, const SerializedMessage& message,
                                    const PacketReceived& packet, Time now) {
  if (TopicTable::Topic* known = topics_.find(name)) {
    if (known->md5sum == message.md5sum && known->type == message.type) return *known;
    if (packet.source != known->source && now - known->used < kTypeStands) {
      throw PayloadError("topic '" + name + "' carries " + known->type + " of " + known->source + " here, so " +
                         message.type + " cannot be published on it before it was silent for " +
                         std::to_string(kTypeStands / std::chrono::seconds(1)) + " s");
    }
    topics_.forget(name);
  }
  // Who comes late must not drive on an old command.
  const bool latched = packet.latched && message.type != "geometry_msgs/Twist";
  TopicTable::Topic topic{message.type, message.md5sum, packet.source, local_.advertise(name, message, latched)};
  topic.subscribers = others_.subscribers(name);
  topic.latched = latched;
  return topics_.add(name, std::move(topic), now);
}

void Inbox::drop(const PacketReceived& packet, const std::string& reason) {
  ++dropped_;
  tell_of(packet, reason);
}

void Inbox::tell_of(const PacketReceived& packet, const std::string& reason) {
  if (topics_told_.size() >= kMostTold || !topics_told_.insert(packet.topic).second) return;
  calls_.tell("A packet from " + packet.source + " for topic '" + escaped(packet.topic) +
              "' is not published: " + reason + " (reported once per topic)");
}

void Inbox::tell_of_slow_subscribers() {
  for (const auto& [topic, messages] : topics_.take_dropped()) {
    dropped_ += messages;
    if (slow_topics_told_.size() >= kMostTold || !slow_topics_told_.insert(topic).second) continue;
    calls_.tell("A subscriber of topic '" + topic + "' is too slow: beyond " +
                std::to_string(SubscriberQueue::kMostMessages) + " messages or " +
                size_text(SubscriberQueue::kMostOctets) + " it loses the oldest (reported once per topic)");
  }
}

void Inbox::tell_of_topics_given_up() {
  for (const auto& [topic, source] : topics_.take_given_up()) {
    if (robots_told_.size() >= kMostTold || !robots_told_.insert(source).second) continue;
    calls_.tell("Topic '" + topic + "' of " + source +
                " is given up: messages of latched topics would keep more than " +
                size_text(TopicTable::kMostKeptOfASource) + " of one robot, or " +
                size_text(TopicTable::kMostKeptOctets) + " of all (reported once per robot)");
  }
}

void Inbox::tell_of_topics_refused() {
  for (const auto& [topic, source, reason, messages] : topics_.take_refused()) {
    dropped_ += messages;
    PacketReceived packet;
    packet.source = source;
    packet.topic = topic;
    tell_of(packet, reason);
  }
}

std::uint64_t Inbox::take_dropped() { return std::exchange(dropped_, 0) + definitions_.take_dropped(); }

}  // namespace adhoc_communication
