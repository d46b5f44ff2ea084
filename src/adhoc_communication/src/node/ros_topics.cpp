#include "node/ros_topics.hpp"

#include <ros/master.h>
#include <ros/publisher.h>
#include <ros/serialization.h>
#include <ros/this_node.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "relay/topic_name.hpp"

// What roscpp needs to know of a type that it publishes: here the octets are there already.
namespace ros {
namespace message_traits {
template <>
struct IsMessage<adhoc_communication::SerializedMessage> : TrueType {};
template <>
struct MD5Sum<adhoc_communication::SerializedMessage> {
  static const char* value(const adhoc_communication::SerializedMessage& message) { return message.md5sum.c_str(); }
};
template <>
struct DataType<adhoc_communication::SerializedMessage> {
  static const char* value(const adhoc_communication::SerializedMessage& message) { return message.type.c_str(); }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<adhoc_communication::SerializedMessage> {
  template <typename Stream>
  static void write(Stream& stream, const adhoc_communication::SerializedMessage& message) {
    std::copy(message.bytes.begin(), message.bytes.end(),
              stream.advance(static_cast<std::uint32_t>(message.bytes.size())));
  }
  static std::uint32_t serializedLength(const adhoc_communication::SerializedMessage& message) {
    return static_cast<std::uint32_t>(message.bytes.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace adhoc_communication {
namespace {

constexpr std::uint32_t kPublisherQueue = 100;

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

class RosPublication : public Publication {
 public:
  explicit RosPublication(ros::Publisher publisher) : publisher_(std::move(publisher)) {}

  std::size_t subscribers() const override { return publisher_.getNumSubscribers(); }

  void publish(const SerializedMessage& message) override { publisher_.publish(message); }

 private:
  ros::Publisher publisher_;
};

}  // namespace

RosTopics::RosTopics(ros::NodeHandle node, std::string prefix) : node_(std::move(node)), prefix_(std::move(prefix)) {}

std::string RosTopics::full_name(const std::string& topic) const {
  return node_.resolveName(local_topic(prefix_, topic));
}

bool RosTopics::others_publish(const std::string& full_name) const {
  const std::vector<std::string> names = nodes_of(full_name, Role::kPublisher);
  return std::any_of(names.begin(), names.end(), [](const auto& name) { return name != ros::this_node::getName(); });
}

/// A relay of this node to other robots is one of them, too.
std::size_t RosTopics::subscribers(const std::string& full_name) const {
  return nodes_of(full_name, Role::kSubscriber).size();
}

std::unique_ptr<Publication> RosTopics::advertise(const std::string& full_name, const SerializedMessage& message,
                                                  bool latched) {
  ros::AdvertiseOptions options(full_name, kPublisherQueue, message.md5sum, message.type, message.definition);
  options.latch = latched;
  ros::Publisher publisher = node_.advertise(options);
  if (!publisher) throw PayloadError("topic '" + full_name + "' cannot be advertised as " + message.type);
  return std::make_unique<RosPublication>(std::move(publisher));
}

}  // namespace adhoc_communication
