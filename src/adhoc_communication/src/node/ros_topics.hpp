// The topics of the ROS master.
#pragma once

#include <ros/node_handle.h>

#include <memory>
#include <optional>
#include <set>
#include <string>

#include "relay/local_topics.hpp"

namespace adhoc_communication {

class RosTopics : public LocalTopics {
 public:
  /// `prefix` is put before every topic: /<self>/ in simulation mode, else empty.
  RosTopics(ros::NodeHandle node, std::string prefix);

  std::string full_name(const std::string& topic) const override;
  std::optional<std::set<std::string>> of_others() const override;
  std::size_t subscribers(const std::string& full_name) const override;
  std::unique_ptr<Publication> advertise(const std::string& full_name, const SerializedMessage& message,
                                         bool latched) override;

 private:
  ros::NodeHandle node_;
  const std::string prefix_;
};

}  // namespace adhoc_communication
