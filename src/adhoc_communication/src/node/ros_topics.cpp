#include "node/ros_topics.hpp"

#include <ros/this_node.h>

#include <algorithm>
#include <utility>

#include "node/ros_graph.hpp"
#include "node/ros_publication.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {

RosTopics::RosTopics(ros::NodeHandle node, std::string prefix) : node_(std::move(node)), prefix_(std::move(prefix)) {}

std::string RosTopics::full_name(const std::string& topic) const {
  return node_.resolveName(local_topic(prefix_, topic));
}

std::optional<std::set<std::string>> RosTopics::of_others() const {
  const std::optional<RosGraph> graph = ask_for_ros_graph();
  if (!graph) return {};
  const auto is_other = [](const std::string& node) { return node != ros::this_node::getName(); };
  std::set<std::string> topics;
  for (const auto& [topic, nodes] : graph->publishers) {
    if (std::any_of(nodes.begin(), nodes.end(), is_other)) topics.insert(topic);
  }
  return topics;
}

/// A relay of this node to other robots is one of them, too.
std::size_t RosTopics::subscribers(const std::string& full_name) const {
  const std::optional<RosGraph> graph = ask_for_ros_graph();
  if (!graph) return 0;
  const auto found = graph->subscribers.find(full_name);
  return found == graph->subscribers.end() ? 0 : found->second.size();
}

std::unique_ptr<Publication> RosTopics::advertise(const std::string& full_name, const SerializedMessage& message,
                                                  bool latched) {
  return std::make_unique<RosPublication>(node_, full_name, message, latched);
}

}  // namespace adhoc_communication
