// The topics that tell which robots come and go.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <mutex>
#include <set>
#include <string>

#include "node/errands.hpp"

namespace adhoc_communication {

/// new_robot and remove_robot (std_msgs/String). Plain latching would keep the last name only; here a late subscriber
/// of new_robot is sent the name of every robot present, and one of remove_robot the last robot lost if it is still
/// away.
class Discovery {
 public:
  static constexpr std::size_t kMostWaiting = 1000;

  Discovery(ros::NodeHandle& node, const std::string& new_robot_topic, const std::string& remove_robot_topic);

  // These return at once: a thread of its own publishes. While the ROS master hangs, names wait; beyond kMostWaiting
  // the oldest are not published, though who subscribes later is told the truth.
  void announce(const std::string& robot);
  void announce_loss(const std::string& robot);

 private:
  void greet(const ros::SingleSubscriberPublisher& subscriber);
  void greet_with_loss(const ros::SingleSubscriberPublisher& subscriber);

  std::mutex mutex_;
  std::set<std::string> present_;
  std::string last_lost_;
  ros::Publisher new_robot_;
  ros::Publisher remove_robot_;
  Errands errands_{kMostWaiting};
};

}  // namespace adhoc_communication
