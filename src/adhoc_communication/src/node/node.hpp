// The ROS node: parameters, topics and services of one robot's radio.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "node/channel_model.hpp"
#include "node/discovery.hpp"
#include "node/engine_host.hpp"
#include "node/injector.hpp"
#include "node/key_file.hpp"
#include "node/options.hpp"
#include "node/service_log.hpp"
#include "node/services.hpp"

namespace adhoc_communication {

class Node {
 public:
  /// Throws LinkError or std::invalid_argument, with nothing advertised, when the options cannot be used.
  explicit Node(const NodeOptions& options);
  ~Node();

 private:
  HostCallbacks callbacks();
  void follow_ground_truth();
  void publish_status(const ros::WallTimerEvent&);
  void shut_down();
  TopicFilter topic_filter() const;
  void reread_keys(const ros::WallTimerEvent&);

  NodeOptions options_;
  const std::string name_prefix_;     ///< /<self>/ in simulation mode, else empty
  const std::string service_prefix_;  ///< what precedes the names of services and of the node's own topics
  ros::NodeHandle node_;
  PositionTable positions_;
  ServiceLog log_;
  std::unique_ptr<Injector> injector_;
  std::unique_ptr<Discovery> discovery_;
  std::unique_ptr<EngineHost> host_;
  std::unique_ptr<Services> services_;
  ros::Publisher status_;
  ros::WallTimer status_timer_;
  std::atomic<bool> shutting_down_{false};
  ros::WallTimer shut_down_timer_;
  std::optional<FileWatch> key_file_;
  ros::WallTimer key_timer_;
  std::vector<ros::Subscriber> ground_truth_;
};

/// Sets the transmit power of a wireless interface; says nothing about interfaces that are not wireless.
/// Returns one sentence when the power could not be set, else nothing.
std::string set_transmit_power(const std::string& interface, int dbm);

}  // namespace adhoc_communication
