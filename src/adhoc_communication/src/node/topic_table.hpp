// The topics that packets of other robots are published on, and the messages that wait for subscribers to connect.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include "adhoc_communication/types.hpp"
#include "node/payload.hpp"

namespace adhoc_communication {

/// `Publisher` gives a topic up when it is destroyed. When the table is full, or a robot has brought more topics than
/// its share, the one used longest ago makes room: of all, or of that robot's. The same goes for the octets of the
/// messages that latched topics keep.
template <typename Publisher>
class TopicTable {
 public:
  static constexpr std::size_t kMostTopics = 256;
  static constexpr std::size_t kMostOfASource = 64;
  static constexpr std::size_t kMostKeptOctets = 64'000'000;     ///< latched
  static constexpr std::size_t kMostKeptOfASource = 32'000'000;  ///< of these, if it is more than one message
  static constexpr std::size_t kMostWaiting = 100;               ///< messages of one topic
  static constexpr std::size_t kMostWaitingOctets = 32'000'000;  ///< of all
  static constexpr Time kLongestConnection = std::chrono::seconds(1);

  struct Topic {
    std::string type;
    std::string md5sum;
    std::string source;  ///< the robot that brought it
    Publisher publisher;
    std::size_t subscribers = 0;  ///< that are to connect
    bool latched = false;
    std::size_t kept = 0;  ///< octets of the message that late subscribers get
    Time connects_until{0};
    Time used{0};
    std::deque<SerializedMessage> waiting{};  ///< until they have
    bool connecting = true;
  };

  Topic* find(const std::string& name, Time now) {
    const auto found = topics_.find(name);
    if (found == topics_.end()) return nullptr;
    found->second.used = now;
    return &found->second;
  }
  bool knows(const std::string& name) const { return topics_.count(name) != 0; }
  std::size_t size() const { return topics_.size(); }
  bool anything_waits() const { return waiting_octets_ > 0; }

  Topic& add(const std::string& name, Topic topic, Time now) {
    const auto of_source = [&](const Topic& other) { return other.source == topic.source; };
    if (count(of_source) >= kMostOfASource) forget_least_used(of_source);
    if (topics_.size() >= kMostTopics) forget_least_used([](const Topic&) { return true; });
    topic.used = now;
    topic.connects_until = now + kLongestConnection;
    return topics_.emplace(name, std::move(topic)).first->second;
  }

  /// What subscribers do not get because they are still connecting is lost to them: until they have, the messages of
  /// that topic wait, and no others. Publishes by `publish` what need not wait (any more).
  template <typename Publish>
  void publish(Topic& topic, SerializedMessage message, Time now, Publish publish) {
    if (topic.connecting) {
      waiting_octets_ += message.bytes.size() + kOverhead;
      topic.waiting.push_back(std::move(message));
      if (topic.waiting.size() >= kMostWaiting || waiting_octets_ >= kMostWaitingOctets) topic.connects_until = now;
      release(topic, now, publish);
    } else {
      put_out(topic, message, publish);
    }
  }
  /// Publishes what has waited for subscribers that have connected, or long enough.
  template <typename Publish>
  void release_all(Time now, Publish publish) {
    for (auto& [name, topic] : topics_) {
      if (topic.connecting) release(topic, now, publish);
    }
  }

 private:
  static constexpr std::size_t kOverhead = 1;  ///< so that messages without octets count

  template <typename Publish>
  void release(Topic& topic, Time now, Publish publish) {
    if (topic.publisher.getNumSubscribers() < topic.subscribers && now < topic.connects_until) return;
    topic.connecting = false;
    for (const SerializedMessage& message : topic.waiting) {
      waiting_octets_ -= message.bytes.size() + kOverhead;
      put_out(topic, message, publish);
    }
    topic.waiting.clear();
  }
  template <typename Publish>
  void put_out(Topic& topic, const SerializedMessage& message, Publish publish) {
    publish(topic, message);
    if (!topic.latched) return;
    kept_octets_ += message.bytes.size() - topic.kept;
    topic.kept = message.bytes.size();
    const auto keeps = [&](const Topic& other) { return other.kept > 0 && &other != &topic; };
    const auto of_source = [&](const Topic& other) { return keeps(other) && other.source == topic.source; };
    while (kept_of(topic.source) > kMostKeptOfASource && count(of_source) > 0) forget_least_used(of_source);
    while (kept_octets_ > kMostKeptOctets && count(keeps) > 0) forget_least_used(keeps);
  }
  std::size_t kept_of(const std::string& source) const {
    return std::accumulate(topics_.begin(), topics_.end(), std::size_t{0}, [&](std::size_t sum, const auto& item) {
      return sum + (item.second.source == source ? item.second.kept : 0);
    });
  }
  template <typename Predicate>
  std::size_t count(Predicate counts) const {
    return static_cast<std::size_t>(
        std::count_if(topics_.begin(), topics_.end(), [&](const auto& item) { return counts(item.second); }));
  }
  template <typename Predicate>
  void forget_least_used(Predicate candidate) {
    auto oldest = topics_.end();
    for (auto topic = topics_.begin(); topic != topics_.end(); ++topic) {
      if (!candidate(topic->second)) continue;
      if (oldest == topics_.end() || topic->second.used < oldest->second.used) oldest = topic;
    }
    for (const SerializedMessage& message : oldest->second.waiting) {
      waiting_octets_ -= message.bytes.size() + kOverhead;
    }
    kept_octets_ -= oldest->second.kept;
    topics_.erase(oldest);
  }

  std::map<std::string, Topic> topics_;
  std::size_t waiting_octets_ = 0;
  std::size_t kept_octets_ = 0;
};

}  // namespace adhoc_communication
