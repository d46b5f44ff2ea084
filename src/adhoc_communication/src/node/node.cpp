#include "node/node.hpp"

#include <adhoc_communication/Status.h>
#include <nav_msgs/Odometry.h>
#include <ros/console.h>

#include <algorithm>
#include <utility>

#include "link/mac_address.hpp"

namespace adhoc_communication {
namespace {

constexpr double kStatusInterval = 1.0;   // s
constexpr double kKeyFileInterval = 0.5;  // s
constexpr double kTimeForResponse = 0.1;  // s, in which the answer of shut_down reaches its caller

/// The link first, because it fails most: only then does the rest of the node come into being.
std::unique_ptr<Link> open_link_for(NodeOptions& options) {
  auto link = open_link(options.interface, options.mac, options.engine.robot_name);
  options.engine.mtu = link->mtu();
  const int largest = link->mtu() + 14;
  if (options.engine.max_frame_size > largest) {
    ROS_WARN("Parameter ~max_frame_size = %d is more than interface %s carries: %d is used",
             options.engine.max_frame_size, options.interface.c_str(), largest);
    options.engine.max_frame_size = largest;
  }
  return link;
}

void read_keys_for(NodeOptions& options) {
  if (options.key_file.empty()) {
    ROS_WARN("Frames are neither encrypted nor authenticated: parameter ~key_file is not set");
    return;
  }
  options.engine.keys = read_key_file(options.key_file);
}

}  // namespace

Node::Node(const NodeOptions& options)
    : options_(options),
      name_prefix_(options.simulation_mode ? "/" + options.engine.robot_name + "/" : ""),
      service_prefix_(name_prefix_ + "adhoc_communication/"),
      log_(options.log_path, options.engine.robot_name) {
  if (!options_.key_file.empty()) key_file_.emplace(options_.key_file);  // before reading: no change goes unnoticed
  read_keys_for(options_);
  auto link = open_link_for(options_);
  ROS_INFO("%s on interface %s with address %s", options_.engine.robot_name.c_str(), options_.interface.c_str(),
           to_text(link->address()).c_str());
  injector_ = std::make_unique<Injector>(node_, name_prefix_, topic_filter());
  discovery_ = std::make_unique<Discovery>(node_, service_prefix_ + options_.topic_new_robot,
                                           service_prefix_ + options_.topic_remove_robot);
  ReceiveFilter filter(options_.engine.robot_name, options_.sim_robot_macs, options_.channel,
                       options_.simulation_mode ? &positions_ : nullptr);
  if (options_.simulation_mode) follow_ground_truth();
  host_ = std::make_unique<EngineHost>(options_.engine, std::move(link), std::move(filter), callbacks());
  services_ = std::make_unique<Services>(node_, service_prefix_, *host_, log_, [this] { shut_down(); });
  status_ = node_.advertise<Status>(service_prefix_ + "status", 1, true);
  status_timer_ = node_.createWallTimer(ros::WallDuration(kStatusInterval), &Node::publish_status, this);
  if (!key_file_) return;
  key_timer_ = node_.createWallTimer(ros::WallDuration(kKeyFileInterval), &Node::reread_keys, this);
}

Node::~Node() {
  host_->stop();  // calls that wait end here, so that the services can stop
  services_->stop();
}

HostCallbacks Node::callbacks() {
  return {[this](PacketReceived packet) { injector_->inject(std::move(packet)); },
          [this](const std::string& robot) { discovery_->announce(robot); },
          [this](const std::string& robot) { discovery_->announce_loss(robot); },
          [this](const std::string& text) { ROS_WARN("Interface %s: %s", options_.interface.c_str(), text.c_str()); }};
}

/// What this node publishes itself, other robots may not.
TopicFilter Node::topic_filter() const {
  TopicFilter filter(options_.inject_allow, options_.inject_deny);
  filter.deny(node_.resolveName(name_prefix_ + "adhoc_communication") + "/*");
  return filter;
}

/// A file that cannot be used leaves the keys as they are.
void Node::reread_keys(const ros::WallTimerEvent&) {
  if (!key_file_->changed()) return;
  try {
    host_->set_keys(read_key_file(options_.key_file));
    ROS_INFO("The keys of '%s' are in use", options_.key_file.c_str());
  } catch (const std::invalid_argument& error) {
    ROS_ERROR("The keys stay as they were: %s", error.what());
  }
}

void Node::follow_ground_truth() {
  for (int i = 0; i < options_.robots_in_simulation; ++i) {
    const std::string robot = "robot_" + std::to_string(i);
    const boost::function<void(const nav_msgs::Odometry::ConstPtr&)> store =
        [this, robot](const nav_msgs::Odometry::ConstPtr& odometry) {
          positions_.set(robot, {odometry->pose.pose.position.x, odometry->pose.pose.position.y});
        };
    ground_truth_.push_back(node_.subscribe<nav_msgs::Odometry>("/" + robot + "/base_pose_ground_truth", 1, store));
  }
}

void Node::publish_status(const ros::WallTimerEvent&) {
  const Statistics statistics = host_->statistics();
  Status status;
  status.stamp = ros::Time::now();
  status.robot_name = options_.engine.robot_name;
  status.interface = options_.interface;
  status.neighbors = host_->neighbors();
  status.robots = host_->robots();
  status.frames_sent = statistics.frames_sent;
  status.bytes_sent = statistics.bytes_sent;
  status.frames_received = statistics.frames_received;
  status.bytes_received = statistics.bytes_received;
  status.packets_sent = statistics.packets_sent;
  status.packets_failed = statistics.packets_failed;
  status.packets_received_by_hops = statistics.packets_received_by_hops;
  status_.publish(status);
}

void Node::shut_down() {
  if (shutting_down_.exchange(true)) return;
  ROS_INFO("Shutting down as asked by service shut_down");
  shut_down_timer_ = node_.createWallTimer(
      ros::WallDuration(kTimeForResponse), [](const ros::WallTimerEvent&) { ros::requestShutdown(); }, true);
}

}  // namespace adhoc_communication
