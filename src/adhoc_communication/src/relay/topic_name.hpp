// Names of topics from the air and from parameters.
#pragma once

#include <string>

namespace adhoc_communication {

/// The local name of a topic below `prefix`, without needless slashes. Throws PayloadError when it is no valid ROS
/// name.
std::string local_topic(const std::string& prefix, const std::string& topic);

}  // namespace adhoc_communication
