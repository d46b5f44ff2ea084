// The node's parameters: names, types, defaults and ranges in one place.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "node/channel_model.hpp"
#include "relay/relay_table.hpp"

namespace XmlRpc {
class XmlRpcValue;
}

namespace adhoc_communication {

constexpr double kLongestLifetime = 86400.0;  ///< s

struct NodeOptions {
  EngineOptions engine;
  std::string interface = "wlan0";
  std::optional<MacAddress> mac;
  bool simulation_mode = false;
  int robots_in_simulation = 10;
  ChannelModel channel;
  std::string topic_new_robot = "new_robot";
  std::string topic_remove_robot = "remove_robot";
  std::map<MacAddress, std::string> sim_robot_macs;
  std::string log_path;
  std::string capture_file;
  int capture_size = 100;  ///< MB
  std::string key_file;
  bool require_key = false;
  std::string inject_allow = "*";
  /// What moves a robot, or misleads it or who watches it.
  std::string inject_deny =
      "/rosout /rosout_agg /clock /tf /tf_static */diagnostics */diagnostics_agg *cmd_vel* */commands/velocity *goal "
      "*initialpose";
  std::vector<RelayEntry> relays;
  double send_lifetime = 0.0;  ///< s, of what the services send; 0: none
  std::string newest_only;     ///< patterns of topics
};

struct Parameter {
  std::string name;
  std::string type;            ///< string, int, double, bool, list or struct
  std::string default_value;   ///< as text
  std::string without_effect;  ///< why setting it changes nothing; empty for all others
  /// Throws std::invalid_argument when the value does not fit the type.
  std::function<void(NodeOptions&, const XmlRpc::XmlRpcValue&)> set;
};

/// Every private parameter the node knows, in the order of the contract.
const std::vector<Parameter>& parameters();

struct OptionsRead {
  NodeOptions options;
  std::vector<std::string> warnings;
};

/// `values` is the struct of the node's private parameters (or invalid when none is set). Throws std::invalid_argument
/// with one sentence that names the parameter, its value and what is allowed.
OptionsRead read_options(const XmlRpc::XmlRpcValue& values, const std::string& host_name);

/// Of the interface. The engine's frames are as long as both it and max_frame_size allow; returns a warning if it is
/// the interface that bounds them.
std::optional<std::string> set_mtu(NodeOptions& options, int mtu);

/// name,mac!name,mac!...  Throws std::invalid_argument.
std::map<MacAddress, std::string> parse_robot_macs(const std::string& text);

}  // namespace adhoc_communication
