// The end of the node.
#pragma once

#include <ros/console.h>

#include <atomic>
#include <string>

namespace adhoc_communication {

/// Set once the node is to end, also by the handler of a signal. ROS goes on until calls under way have got their
/// answer.
inline std::atomic<bool> asked_to_end{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

/// For a reason that leaves the node of no use.
inline void end_node(const std::string& reason) {
  ROS_FATAL("The node ends: %s", reason.c_str());
  asked_to_end = true;
}

}  // namespace adhoc_communication
