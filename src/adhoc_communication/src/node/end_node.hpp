// The end of the node for a reason that leaves it of no use.
#pragma once

#include <ros/console.h>
#include <ros/init.h>

#include <string>

namespace adhoc_communication {

inline void end_node(const std::string& reason) {
  ROS_FATAL("The node ends: %s", reason.c_str());
  ros::requestShutdown();
}

}  // namespace adhoc_communication
