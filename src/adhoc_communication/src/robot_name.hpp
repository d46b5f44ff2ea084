// What a robot can be called.
#pragma once

#include <algorithm>
#include <cctype>
#include <string>

namespace adhoc_communication {

/// The same rules as for a ROS name of one element; host names add '-' and '.'.
inline bool is_robot_name(const std::string& name) {
  constexpr std::size_t kLongestName = 64;
  if (name.empty() || name.size() > kLongestName) return false;
  return std::all_of(name.begin(), name.end(), [](unsigned char character) {
    return std::isalnum(character) || character == '_' || character == '-' || character == '.';
  });
}

}  // namespace adhoc_communication
