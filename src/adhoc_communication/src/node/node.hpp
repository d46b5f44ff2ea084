// The ROS node: parameters, topics and services of one robot's radio.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "link/capture_link.hpp"
#include "node/channel_model.hpp"
#include "node/diagnostics.hpp"
#include "node/discovery.hpp"
#include "node/engine_host.hpp"
#include "node/injector.hpp"
#include "node/key_file.hpp"
#include "node/network_logs.hpp"
#include "node/network_state.hpp"
#include "node/options.hpp"
#include "node/record_log.hpp"
#include "node/service_log.hpp"
#include "node/services.hpp"
#include "node/topic_relay.hpp"

namespace adhoc_communication {

class Node {
 public:
  /// Throws LinkError or std::invalid_argument, with nothing advertised, when the options cannot be used.
  explicit Node(const NodeOptions& options);
  ~Node();

 private:
  HostCallbacks callbacks();
  std::unique_ptr<Link> captured(std::unique_ptr<Link> link);
  void follow_ground_truth();
  void carry_relays();
  void tell_state(const ros::WallTimerEvent&);
  NodeState state(const Snapshot& snapshot) const;
  void tell_rows_lost(std::uint64_t rows);
  void shut_down();
  TopicFilter topic_filter() const;
  InboxCalls inbox_calls();
  void reread_keys(const ros::WallTimerEvent&);

  NodeOptions options_;
  const std::string name_prefix_;     ///< /<self>/ in simulation mode, else empty
  const std::string service_prefix_;  ///< what precedes the names of services and of the node's own topics
  ros::NodeHandle node_;
  PositionTable positions_;
  ServiceLog log_;
  NetworkLogs network_logs_;
  RecordLog record_log_;
  bool disk_full_told_ = false;
  Diagnostics diagnostics_;
  std::shared_ptr<CaptureFile> capture_;
  std::unique_ptr<Injector> injector_;
  std::unique_ptr<Discovery> discovery_;
  std::unique_ptr<TopicRelay> relay_;
  std::unique_ptr<EngineHost> host_;
  std::unique_ptr<Services> services_;
  ros::Publisher status_publisher_;
  ros::Publisher network_state_publisher_;
  ros::Publisher diagnostics_publisher_;
  ros::WallTimer state_timer_;
  std::optional<FileWatch> key_file_;
  ros::WallTimer key_timer_;
  std::vector<ros::Subscriber> ground_truth_;
};

/// Sets the transmit power of a wireless interface; says nothing about interfaces that are not wireless.
/// Returns one sentence when the power could not be set, else nothing.
std::string set_transmit_power(const std::string& interface, int dbm);

}  // namespace adhoc_communication
