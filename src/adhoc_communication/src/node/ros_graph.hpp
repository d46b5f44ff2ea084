// Who publishes what and who subscribes to it, as the ROS master knows it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace adhoc_communication {

struct RosGraph {
  using Nodes = std::map<std::string, std::vector<std::string>>;  ///< their names by topic

  Nodes publishers;
  Nodes subscribers;
};

/// Nothing when the master does not answer within a second. roscpp itself would wait for as long as it takes.
std::optional<RosGraph> ask_for_ros_graph();

}  // namespace adhoc_communication
