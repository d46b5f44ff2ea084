#include "node/ros_topics.hpp"

#include <ros/this_node.h>

#include <algorithm>
#include <utility>

#include "node/ros_graph.hpp"
#include "node/ros_publication.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {
namespace {

/// A relay of this node to other robots is a subscriber, too.
std::optional<TopicsInUse> topics_in_use() {
  const std::optional<RosGraph> graph = ask_for_ros_graph();
  if (!graph) return std::nullopt;
  const auto is_other = [](const std::string& node) { return node != ros::this_node::getName(); };
  TopicsInUse in_use;
  for (const auto& [topic, nodes] : graph->publishers) {
    if (std::any_of(nodes.begin(), nodes.end(), is_other)) in_use.of_others.insert(topic);
  }
  for (const auto& [topic, nodes] : graph->subscribers) in_use.subscribers[topic] = nodes.size();
  return in_use;
}

}  // namespace

RosTopics::RosTopics(ros::NodeHandle node, std::string prefix) : node_(std::move(node)), prefix_(std::move(prefix)) {}

std::string RosTopics::full_name(const std::string& topic) const {
  return node_.resolveName(local_topic(prefix_, topic));
}

void RosTopics::ask() {
  errands_.add([this] {
    Answer answer{topics_in_use()};
    const std::lock_guard<std::mutex> lock(mutex_);
    answer_ = std::move(answer);
  });
}

std::optional<LocalTopics::Answer> RosTopics::take_answer() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(answer_, std::nullopt);
}

std::unique_ptr<Publication> RosTopics::advertise(const std::string& full_name, const SerializedMessage& message,
                                                  bool latched) {
  return std::make_unique<RosPublication>(node_, errands_, full_name, message, latched);
}

}  // namespace adhoc_communication
