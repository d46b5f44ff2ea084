#include "node/ros_topics.hpp"

#include <ros/master.h>
#include <ros/this_node.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "node/ros_publication.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {
namespace {

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
  return std::make_unique<RosPublication>(node_, full_name, message, latched);
}

}  // namespace adhoc_communication
