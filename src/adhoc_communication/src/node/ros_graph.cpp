#include "node/ros_graph.hpp"

#include <ros/master.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcException.h>

namespace adhoc_communication {
namespace {

constexpr double kPatience = 1.0;  ///< s

RosGraph::Nodes nodes_by_topic(XmlRpc::XmlRpcValue& entries) {
  RosGraph::Nodes nodes;
  for (int i = 0; i < entries.size(); ++i) {
    std::vector<std::string>& names = nodes[entries[i][0]];
    for (int node = 0; node < entries[i][1].size(); ++node) names.push_back(entries[i][1][node]);
  }
  return nodes;
}

}  // namespace

std::optional<RosGraph> ask_for_ros_graph() {
  XmlRpc::XmlRpcClient master(ros::master::getHost().c_str(), static_cast<int>(ros::master::getPort()), "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  if (!master.executeNonBlock("getSystemState", request)) return {};
  master._disp.work(kPatience);
  if (!master.executeCheckDone(response) || master.isFault()) return {};
  try {
    XmlRpc::XmlRpcValue& state = response[2];  // after a code and a text
    return RosGraph{nodes_by_topic(state[0]), nodes_by_topic(state[1])};
  } catch (const XmlRpc::XmlRpcException&) {
    return {};
  }
}

}  // namespace adhoc_communication
