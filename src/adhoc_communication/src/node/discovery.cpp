#include "node/discovery.hpp"

#include <ros/single_subscriber_publisher.h>
#include <ros/topic_manager.h>
#include <std_msgs/String.h>

namespace adhoc_communication {
namespace {

constexpr std::uint32_t kQueue = 1000;

std_msgs::String text(const std::string& robot) {
  std_msgs::String message;
  message.data = robot;
  return message;
}

/// Declared as latched, so that subscribers and bags know what to expect...
ros::Publisher advertise(ros::NodeHandle& node, const std::string& topic, const ros::SubscriberStatusCallback& greet) {
  ros::AdvertiseOptions options;
  options.init<std_msgs::String>(topic, kQueue, greet);
  options.latch = true;
  return node.advertise(options);
}

/// ...but past the Publisher, which would keep the message and send a name that may be out of date to late subscribers.
void publish(const ros::Publisher& publisher, const std::string& robot) {
  ros::TopicManager::instance()->publish(publisher.getTopic(), text(robot));
}

}  // namespace

Discovery::Discovery(ros::NodeHandle& node, const std::string& new_robot_topic, const std::string& remove_robot_topic)
    : new_robot_(advertise(node, new_robot_topic, [this](const auto& subscriber) { greet(subscriber); })),
      remove_robot_(
          advertise(node, remove_robot_topic, [this](const auto& subscriber) { greet_with_loss(subscriber); })) {}

void Discovery::announce(const std::string& robot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  present_.insert(robot);
  errands_.add([publisher = new_robot_, robot] { publish(publisher, robot); });
}

void Discovery::announce_loss(const std::string& robot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  present_.erase(robot);
  last_lost_ = robot;
  errands_.add([publisher = remove_robot_, robot] { publish(publisher, robot); });
}

void Discovery::greet(const ros::SingleSubscriberPublisher& subscriber) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const auto& robot : present_) subscriber.publish(text(robot));
}

void Discovery::greet_with_loss(const ros::SingleSubscriberPublisher& subscriber) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!last_lost_.empty() && present_.count(last_lost_) == 0) subscriber.publish(text(last_lost_));
}

}  // namespace adhoc_communication
