#include "node/injector.hpp"

#include <geometry_msgs/Twist.h>
#include <ros/console.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/this_node.h>
#include <topic_tools/shape_shifter.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/compression.hpp"
#include "link/steady_now.hpp"
#include "node/definition_md5.hpp"
#include "node/end_node.hpp"
#include "run_guarded.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMaxReportedTopics = 256;
constexpr std::size_t kMaxQueuedPackets = 1000;
constexpr std::size_t kMaxQueuedOctets = 100'000'000;
constexpr std::uint32_t kPublisherQueue = 100;
constexpr std::chrono::milliseconds kConnectionPeriod{5};  ///< in which it is looked whether subscribers have connected

enum class Role { kPublisher = 0, kSubscriber = 1 };

/// Nodes that publish a topic, or subscribe to it, as the master knows them.
std::vector<std::string> nodes_of(const std::string& topic, Role role) {
  XmlRpc::XmlRpcValue request, response, state;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getSystemState", request, response, state, false)) return {};
  XmlRpc::XmlRpcValue& topics = state[static_cast<int>(role)];
  std::vector<std::string> names;
  for (int i = 0; i < topics.size(); ++i) {
    if (static_cast<std::string>(topics[i][0]) != topic) continue;
    for (int node = 0; node < topics[i][1].size(); ++node) names.push_back(topics[i][1][node]);
  }
  return names;
}

bool others_publish(const std::string& topic) {
  const std::vector<std::string> names = nodes_of(topic, Role::kPublisher);
  return std::any_of(names.begin(), names.end(), [](const auto& name) { return name != ros::this_node::getName(); });
}

void publish_now(const TopicTable<ros::Publisher>::Topic& topic, const SerializedMessage& message) {
  topic_tools::ShapeShifter shape;
  shape.morph(message.md5sum, message.type, message.definition, "1");
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(message.bytes.data()),  // an input stream only reads
                                     static_cast<std::uint32_t>(message.bytes.size()));
  shape.read(stream);
  topic.publisher.publish(shape);
}

}  // namespace

std::string local_topic(const std::string& prefix, const std::string& topic) {
  std::string error;
  if (topic.empty() || topic[0] == '~' || !ros::names::validate(topic, error)) {
    throw PayloadError("topic '" + escaped(topic) + "' is not a valid topic name");
  }
  const auto first = topic.find_first_not_of('/');
  if (first == std::string::npos) throw PayloadError("topic '" + topic + "' has no name");
  return ros::names::clean(prefix.empty() ? topic : prefix + topic.substr(first));
}

Injector::Injector(ros::NodeHandle node, std::string prefix, TopicFilter filter, AskForDefinition ask_for_definition,
                   AnswerRequest answer_request)
    : node_(std::move(node)),
      prefix_(std::move(prefix)),
      filter_(std::move(filter)),
      ask_for_definition_(std::move(ask_for_definition)),
      answer_request_(std::move(answer_request)) {
  thread_ = std::thread([this] { run(); });
}

Injector::~Injector() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_all();
  thread_.join();
}

void Injector::inject(PacketReceived packet) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (queue_.size() >= kMaxQueuedPackets || queued_octets_ + packet.payload.size() > kMaxQueuedOctets) {
    ++dropped_;
    lock.unlock();
    ROS_ERROR_THROTTLE(5.0, "Packets arrive faster than they can be published; one for topic '%s' was dropped",
                       escaped(packet.topic).c_str());
    return;
  }
  queued_octets_ += packet.payload.size();
  queue_.push_back(std::move(packet));
  arrived_.notify_one();
}

Injector::Report Injector::report() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {queue_.size(), queued_octets_, dropped_};
}

void Injector::run() {
  run_guarded(
      "publishing", [this] { work(); }, end_node);
}

void Injector::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (wait_for_packet(lock)) {
    PacketReceived packet = std::move(queue_.front());
    queue_.pop_front();
    queued_octets_ -= packet.payload.size();
    lock.unlock();
    try {
      take(packet);
    } catch (const std::exception& error) {
      drop(packet, error.what());
    }
    lock.lock();
  }
}

/// False when there will be none any more.
bool Injector::wait_for_packet(std::unique_lock<std::mutex>& lock) {
  const auto due = [this] { return stopping_ || !queue_.empty(); };
  while (topics_.anything_waits()) {
    const bool arrived = arrived_.wait_for(lock, kConnectionPeriod, due);
    lock.unlock();
    topics_.release_all(steady_now(), publish_now);
    lock.lock();
    if (arrived) return !stopping_;
  }
  arrived_.wait(lock, due);
  return !stopping_;
}

void Injector::take(PacketReceived& packet) {
  if (!unpack(packet)) throw PayloadError("it is not what it says that it unpacks to");
  if (packet.payload_type == static_cast<std::uint8_t>(PayloadType::kDefinitionRequest)) return answer_request_(packet);
  definitions_.expire(steady_now());
  const bool is_definition = packet.payload_type == static_cast<std::uint8_t>(PayloadType::kDefinition);
  if (!is_definition) check_topic(full_name(packet.topic));
  SerializedMessage message = decode(packet);
  // Unasked definitions are not kept: nobody can fill the memory with them.
  if (is_definition && definitions_.awaits({message.type, message.md5sum})) learn_definition(message);
  if (!is_definition && complete(message, packet)) publish(packet, std::move(message));
  count_dropped(definitions_.take_dropped());
}

/// As the rules and the tables of this class have it: one topic has one name.
std::string Injector::full_name(const std::string& topic) const {
  return node_.resolveName(local_topic(prefix_, topic));
}

void Injector::check_topic(const std::string& topic) const {
  if (!filter_.admits(topic)) {
    throw PayloadError("other robots may not publish '" + topic + "' here (parameters inject_allow, inject_deny)");
  }
  if (topics_.knows(topic) || filter_.names(topic)) return;
  if (others_publish(topic)) {
    throw PayloadError("nodes of this robot publish '" + topic + "', so others may not, unless inject_allow names it");
  }
}

/// The MD5 sum is what subscribers and other senders go by, so it has to be that of the definition.
void Injector::learn_definition(const SerializedMessage& message) {
  if (md5_of_definition(message.type, message.definition) != message.md5sum) {
    throw PayloadError("the definition of " + message.type + " does not have the MD5 sum " + message.md5sum);
  }
  for (const PacketReceived& waited : definitions_.learn({message.type, message.md5sum}, message.definition)) {
    try {
      SerializedMessage complete = decode(waited);
      complete.definition = message.definition;
      publish(waited, std::move(complete));
    } catch (const std::exception& error) {
      drop(waited, error.what());
    }
  }
}

bool Injector::complete(SerializedMessage& message, const PacketReceived& packet) {
  const TypeName type{message.type, message.md5sum};
  if (packet.payload_type == static_cast<std::uint8_t>(PayloadType::kAnyMessage)) {
    const std::string* known = definitions_.find(type);
    if (known == nullptr && !message.definition.empty()) learn_definition(message);
    if (known != nullptr) message.definition = *known;
    return true;
  }
  if (packet.payload_type != static_cast<std::uint8_t>(PayloadType::kMessageByType)) return true;
  if (const std::string* definition = definitions_.find(type)) {
    message.definition = *definition;
    return true;
  }
  if (definitions_.hold(packet, type, steady_now())) ask_for_definition_(packet.source, type);
  return false;
}

void Injector::publish(const PacketReceived& packet, SerializedMessage message) {
  Topics::Topic& topic = topic_for(full_name(packet.topic), message, packet);
  topics_.publish(topic, std::move(message), steady_now(), publish_now);
}

Injector::Topics::Topic& Injector::topic_for(const std::string& name, const SerializedMessage& message,
                                             const PacketReceived& packet) {
  if (Topics::Topic* known = topics_.find(name, steady_now())) {
    if (known->md5sum == message.md5sum && known->type == message.type) return *known;
    throw PayloadError("topic '" + name + "' carries " + known->type + " here, so " + message.type +
                       " cannot be published on it");
  }
  ros::AdvertiseOptions options(name, kPublisherQueue, message.md5sum, message.type, message.definition);
  // Who comes late must not drive on an old command.
  options.latch = packet.latched && message.type != ros::message_traits::datatype<geometry_msgs::Twist>();
  const ros::Publisher publisher = node_.advertise(options);
  if (!publisher) throw PayloadError("topic '" + name + "' cannot be advertised as " + message.type);
  // A relay of this node to other robots is one of the subscribers, too.
  const std::size_t subscribers = nodes_of(name, Role::kSubscriber).size();
  return topics_.add(name, {message.type, message.md5sum, packet.source, publisher, subscribers, options.latch},
                     steady_now());
}

void Injector::count_dropped(std::uint64_t packets) {
  const std::lock_guard<std::mutex> lock(mutex_);
  dropped_ += packets;
}

void Injector::drop(const PacketReceived& packet, const std::string& reason) {
  count_dropped(1);
  if (reported_topics_.size() >= kMaxReportedTopics || !reported_topics_.insert(packet.topic).second) return;
  ROS_ERROR("A packet of %zu octets from %s for topic '%s' is not published: %s (reported once per topic)",
            packet.payload.size(), packet.source.c_str(), escaped(packet.topic).c_str(), reason.c_str());
}

}  // namespace adhoc_communication
