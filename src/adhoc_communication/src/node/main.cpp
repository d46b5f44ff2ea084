#include <malloc.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <algorithm>
#include <climits>
#include <csignal>
#include <cstring>
#include <iostream>
#include <stdexcept>

#include "link/capability.hpp"
#include "link/link.hpp"
#include "node/end_node.hpp"
#include "node/node.hpp"
#include "node/options.hpp"

namespace {

using adhoc_communication::NodeOptions;

std::string host_name() {
  char name[HOST_NAME_MAX + 1] = {};
  gethostname(name, sizeof name - 1);
  return name;
}

/// The original reads log_path beside the node, its launch files set it in the node's private namespace: both count.
void add_public_log_path(XmlRpc::XmlRpcValue& values) {
  std::string log_path;
  if (values.valid() && values.getType() != XmlRpc::XmlRpcValue::TypeStruct) return;  // refused later
  const bool is_private = values.valid() && values.hasMember("log_path");
  if (!is_private && ros::NodeHandle().getParam("log_path", log_path)) values["log_path"] = log_path;
}

NodeOptions read_parameters() {
  XmlRpc::XmlRpcValue values;
  ros::param::get(ros::this_node::getName(), values);
  add_public_log_path(values);
  const auto [options, warnings] = adhoc_communication::read_options(values, host_name());
  for (const auto& warning : warnings) ROS_WARN("The %s", warning.c_str());
  return options;
}

/// Terminals end programs with SIGINT, service managers and containers with SIGTERM. roscpp would see to the first one
/// only, and close connections before calls have got their answer.
void end_on_signals() {
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, [](int) { adhoc_communication::asked_to_end = true; });
}

void serve_until_the_end() {
  const ros::WallDuration longest_wait(0.1);
  while (ros::ok() && !adhoc_communication::asked_to_end) {
    ros::getGlobalCallbackQueue()->callAvailable(longest_wait);
  }
}

/// Blocks from this size on go back to the system as soon as they are free. By itself, the C library keeps what large
/// packets took.
void return_large_blocks() {
  constexpr int kLarge = 256 * 1024;
  mallopt(M_MMAP_THRESHOLD, kLarge);
}

int list_parameters() {
  for (const auto& parameter : adhoc_communication::parameters()) {
    std::cout << parameter.name << '\t' << parameter.type << '\t' << parameter.default_value << '\t'
              << (parameter.without_effect.empty() ? "effect" : "no effect") << '\n';
  }
  return 0;
}

bool asks_for_help(int argc, char** argv) {
  return std::any_of(argv + 1, argv + argc,
                     [](const char* word) { return std::strcmp(word, "--help") == 0 || std::strcmp(word, "-h") == 0; });
}

int print_help() {
  std::cout << "usage: rosrun adhoc_communication adhoc_communication [_PARAMETER:=VALUE ...] [NAME:=NEW_NAME ...]\n"
               "       rosrun adhoc_communication adhoc_communication --list-parameters\n\n"
               "The radio of a robot: neighbours, routes, reliable delivery and groups over raw Ethernet frames.\n\n"
               "Started by: robot.launch of mr_launch, or adhoc.launch of adhoc_communication\n"
               "Parameters: Parameters, in the README of adhoc_communication\n\n"
               "A node of ROS: it waits for a master (roscore, or a launch file) and runs until it is told to end.\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  adhoc_communication::lower_capabilities();  // before the first thread, which would keep them
  if (argc > 1 && asks_for_help(argc, argv)) return print_help();
  if (argc > 1 && std::strcmp(argv[1], "--list-parameters") == 0) return list_parameters();
  return_large_blocks();
  ros::init(argc, argv, "adhoc_communication", ros::init_options::NoSigintHandler);
  // Waits for the master, and until then signals end the process as they are. roscpp shuts down, its console too, when
  // the last handle goes.
  const ros::NodeHandle keeps_ros_running;
  ros::master::setRetryTimeout(ros::WallDuration(1.0));  // without one a master that has gone is waited for for ever
  end_on_signals();
  try {
    const NodeOptions options = read_parameters();
    adhoc_communication::Node node(options);
    if (!options.simulation_mode) {
      const std::string complaint = adhoc_communication::set_transmit_power(options.interface, options.channel.p_tx);
      if (!complaint.empty()) ROS_WARN("%s", complaint.c_str());
    }
    serve_until_the_end();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
