#include "relay/topic_table.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace adhoc_communication {
namespace {

/// What waits counts as this much more, so that messages without octets count.
constexpr std::size_t kOverhead = 1;

}  // namespace

TopicTable::Topic* TopicTable::find(const std::string& name) {
  const auto found = topics_.find(name);
  return found == topics_.end() ? nullptr : &found->second;
}

TopicTable::Topic& TopicTable::add(const std::string& name, Topic topic, Time now) {
  const Predicate of_source = [&](const Topic& other) { return other.source == topic.source; };
  if (count(of_source) >= kMostOfASource) forget_least_used(of_source);
  if (topics_.size() >= kMostTopics) forget_least_used([](const Topic&) { return true; });
  topic.used = now;
  topic.connects_until = now + kLongestOffer;
  return topics_.emplace(name, std::move(topic)).first->second;
}

void TopicTable::forget(const std::string& name) {
  if (const auto found = topics_.find(name); found != topics_.end()) forget(found);
}

void TopicTable::publish(Topic& topic, SerializedMessage message, Time now) {
  topic.used = now;
  if (!topic.connecting) return put_out(topic, message);
  waiting_octets_ += message.bytes.size() + kOverhead;
  topic.waiting.push_back(std::move(message));
  const bool full = topic.waiting.size() >= kMostWaiting || waiting_octets_ >= kMostWaitingOctets;
  if (full || !connects(topic, now)) release(topic);
}

void TopicTable::release_all(Time now) {
  subscribers_wait_ = false;
  for (auto& [name, topic] : topics_) {
    if (topic.connecting && !connects(topic, now)) release(topic);
    subscribers_wait_ = topic.publication->serve() || subscribers_wait_;
  }
  give_up_refused();
}

void TopicTable::give_up_refused() {
  for (auto topic = topics_.begin(); topic != topics_.end();) {
    const auto next = std::next(topic);
    if (const std::string reason = topic->second.publication->refusal(); !reason.empty()) {
      refused_.push_back({topic->first, topic->second.source, reason, topic->second.waiting.size()});
      forget(topic);
    }
    topic = next;
  }
}

std::vector<TopicTable::Dropped> TopicTable::take_dropped() {
  std::vector<Dropped> dropped;
  for (auto& [name, topic] : topics_) {
    if (const std::uint64_t messages = topic.publication->take_dropped(); messages > 0) {
      dropped.push_back({name, messages});
    }
  }
  return dropped;
}

bool TopicTable::connects(Topic& topic, Time now) {
  if (!topic.offered && topic.publication->offered()) {
    topic.offered = true;
    topic.connects_until = now + kLongestConnection;
  }
  const bool complete = topic.offered && topic.publication->subscribers() >= topic.subscribers;
  return !complete && now < topic.connects_until;
}

void TopicTable::release(Topic& topic) {
  topic.connecting = false;
  for (const SerializedMessage& message : topic.waiting) {
    waiting_octets_ -= message.bytes.size() + kOverhead;
    put_out(topic, message);
  }
  topic.waiting.clear();
}

void TopicTable::put_out(Topic& topic, const SerializedMessage& message) {
  topic.publication->publish(message);
  subscribers_wait_ = topic.publication->serve() || subscribers_wait_;
  if (!topic.latched) return;
  kept_octets_ += message.bytes.size() - topic.kept;
  topic.kept = message.bytes.size();
  make_room_beside(topic);
}

void TopicTable::make_room_beside(const Topic& topic) {
  const auto keeps = [&](const Topic& other) { return other.kept > 0 && &other != &topic; };
  const auto give_up_of = [&](const std::string& source) {
    const auto oldest = least_used([&](const Topic& other) { return keeps(other) && other.source == source; });
    if (oldest == topics_.end()) return false;
    given_up_.push_back({oldest->first, source});
    forget(oldest);
    return true;
  };
  const auto keeps_less = [&](const auto& a, const auto& b) {
    return (keeps(a.second) ? kept_of(a.second.source) : 0) < (keeps(b.second) ? kept_of(b.second.source) : 0);
  };
  while (kept_of(topic.source) > kMostKeptOfASource && give_up_of(topic.source)) continue;
  while (kept_octets_ > kMostKeptOctets &&
         give_up_of(std::max_element(topics_.begin(), topics_.end(), keeps_less)->second.source)) {
    continue;
  }
}

std::size_t TopicTable::kept_of(const std::string& source) const {
  return std::accumulate(topics_.begin(), topics_.end(), std::size_t{0}, [&](std::size_t sum, const auto& item) {
    return sum + (item.second.source == source ? item.second.kept : 0);
  });
}

std::size_t TopicTable::count(const Predicate& counts) const {
  return static_cast<std::size_t>(
      std::count_if(topics_.begin(), topics_.end(), [&](const auto& item) { return counts(item.second); }));
}

std::map<std::string, TopicTable::Topic>::iterator TopicTable::least_used(const Predicate& candidate) {
  auto oldest = topics_.end();
  for (auto topic = topics_.begin(); topic != topics_.end(); ++topic) {
    if (!candidate(topic->second)) continue;
    if (oldest == topics_.end() || topic->second.used < oldest->second.used) oldest = topic;
  }
  return oldest;
}

void TopicTable::forget(std::map<std::string, Topic>::iterator topic) {
  for (const SerializedMessage& message : topic->second.waiting) waiting_octets_ -= message.bytes.size() + kOverhead;
  kept_octets_ -= topic->second.kept;
  topics_.erase(topic);
}

}  // namespace adhoc_communication
