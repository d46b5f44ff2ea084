#include "node/options.hpp"

#include <xmlrpcpp/XmlRpcValue.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

#include "link/ethernet.hpp"
#include "link/mac_address.hpp"
#include "node/relay_options.hpp"
#include "node/timing_options.hpp"
#include "robot_name.hpp"

namespace adhoc_communication {
namespace {

using XmlRpc::XmlRpcValue;

std::string text_of(const XmlRpcValue& value) {
  std::ostringstream text;
  value.write(text);
  return text.str();
}

template <typename T>
T convert(const XmlRpcValue& value);

template <>
std::string convert(const XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeString) throw std::invalid_argument("is not a string");
  return static_cast<std::string>(XmlRpcValue(value));
}

template <>
int convert(const XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeInt) throw std::invalid_argument("is not an integer");
  return static_cast<int>(XmlRpcValue(value));
}

template <>
double convert(const XmlRpcValue& value) {
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int>(XmlRpcValue(value));
  if (value.getType() != XmlRpcValue::TypeDouble) throw std::invalid_argument("is not a number");
  return static_cast<double>(XmlRpcValue(value));
}

template <>
bool convert(const XmlRpcValue& value) {
  if (value.getType() != XmlRpcValue::TypeBoolean) throw std::invalid_argument("is not true or false");
  return static_cast<bool>(XmlRpcValue(value));
}

std::string to_default(const std::string& value) { return value; }
std::string to_default(bool value) { return value ? "true" : "false"; }
std::string to_default(int value) { return std::to_string(value); }
std::string to_default(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string type_name(const std::string&) { return "string"; }
std::string type_name(bool) { return "bool"; }
std::string type_name(int) { return "int"; }
std::string type_name(double) { return "double"; }

/// A parameter that is stored in the member that `member` selects.
template <typename Member>
Parameter stored(const std::string& name, Member member) {
  NodeOptions defaults;
  auto& default_value = member(defaults);
  using Value = std::decay_t<decltype(default_value)>;
  return {name, type_name(default_value), to_default(default_value), "",
          [member](NodeOptions& options, const XmlRpcValue& value) { member(options) = convert<Value>(value); }};
}

/// A parameter that has to be understood first.
template <typename Value>
Parameter parsed(const std::string& name, const Value& default_value, std::function<void(NodeOptions&, Value)> store) {
  return {name, type_name(default_value), to_default(default_value), "",
          [store](NodeOptions& options, const XmlRpcValue& value) { store(options, convert<Value>(value)); }};
}

Parameter without_effect(const std::string& name, const std::string& type, const std::string& default_value,
                         const std::string& reason) {
  return {name, type, default_value, reason, [](NodeOptions&, const XmlRpcValue&) {}};
}

/// Its type and range are still checked, so that a mistake does not wait for the day the parameter counts.
template <typename Member>
Parameter checked_without_effect(const std::string& name, const std::string& reason, Member member) {
  Parameter parameter = stored(name, member);
  parameter.without_effect = reason;
  return parameter;
}

void set_packet_size(NodeOptions& options, int size) {
  if (size < 1) throw std::invalid_argument("is below 1 octet");
  options.engine.max_packet_size = static_cast<std::size_t>(size);
}

bool is_topic_element(const std::string& name) {
  if (name.empty() || (!std::isalpha(static_cast<unsigned char>(name[0])) && name[0] != '_')) return false;
  return std::all_of(name.begin(), name.end(), [](unsigned char character) {
    return std::isalnum(character) || character == '_' || character == '/';
  });
}

[[noreturn]] void refuse(const std::string& name, const std::string& value, const std::string& why) {
  throw std::invalid_argument("parameter ~" + name + " = " + value + " " + why);
}

void require_range(const std::string& name, int value, int low, int high) {
  if (value >= low && value <= high) return;
  refuse(name, std::to_string(value), "is outside " + std::to_string(low) + " .. " + std::to_string(high));
}

/// As the node will take them later.
void check_relays(const NodeOptions& options) {
  RelayTable table(options.engine.robot_name);
  try {
    for (const RelayEntry& entry : options.relays) table.add(entry);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("parameter ~relay: " + std::string(error.what()));
  }
}

void check(const NodeOptions& options) {
  const std::string& name = options.engine.robot_name;
  if (!is_robot_name(name)) {
    refuse("robot_name", "'" + name + "'", "is not a robot name: 1 to 64 letters, digits, '_', '-' or '.'");
  }
  if (name.rfind("mc_", 0) == 0) {
    refuse("robot_name", "'" + name + "'",
           "begins with mc_, as names of groups do: what is sent to it would go to a group");
  }
  if (options.simulation_mode && !robot_number(name)) {
    refuse("robot_name", "'" + name + "'", "must be robot_<integer> in simulation_mode");
  }
  if (options.interface.empty()) refuse("interface", "''", "names no network interface");
  require_range("robots_in_simulation", options.robots_in_simulation, 0, 1000);
  require_range("p_thres", options.channel.p_thres, -200, 100);
  require_range("p_tx", options.channel.p_tx, -100, 100);
  require_range("n_model", options.channel.n_model, 0, 20);
  require_range("l_0_model", options.channel.l_0_model, 0, 200);
  require_range("capture_size", options.capture_size, 0, 1'000'000);
  if (!(options.send_lifetime >= 0.0 && options.send_lifetime <= kLongestLifetime)) {
    refuse("send_lifetime", to_default(options.send_lifetime), "is outside 0 .. 86400");
  }
  if (!is_topic_element(options.topic_new_robot)) {
    refuse("topic_new_robot", "'" + options.topic_new_robot + "'", "is not a topic name");
  }
  if (!is_topic_element(options.topic_remove_robot)) {
    refuse("topic_remove_robot", "'" + options.topic_remove_robot + "'", "is not a topic name");
  }
  if (options.require_key && options.key_file.empty()) refuse("require_key", "true", "needs ~key_file");
  check_relays(options);
  validate(options.engine);
}

/// As in a shell, and as the other nodes take it: no shell expands what follows `:=`.
std::string with_home(const std::string& path) {
  const char* home = std::getenv("HOME");
  const bool at_home = path == "~" || path.rfind("~/", 0) == 0;
  return at_home && home != nullptr ? home + path.substr(1) : path;
}

/// A node whose address stands in sim_robot_macs needs no `mac` of its own.
void complete(NodeOptions& options, const std::string& host_name) {
  if (options.engine.robot_name.empty()) options.engine.robot_name = host_name;
  for (std::string* path : {&options.log_path, &options.key_file, &options.capture_file}) *path = with_home(*path);
  if (options.mac) return;
  for (const auto& [address, name] : options.sim_robot_macs) {
    if (name == options.engine.robot_name) options.mac = address;
  }
}

void read_one(const std::string& name, const XmlRpcValue& value, OptionsRead& result) {
  const auto known = std::find_if(parameters().begin(), parameters().end(),
                                  [&name](const Parameter& parameter) { return parameter.name == name; });
  if (known == parameters().end()) {
    const bool is_namespace = value.getType() == XmlRpcValue::TypeStruct;
    if (!is_namespace) result.warnings.push_back("parameter ~" + name + " is unknown and has no effect");
    return;
  }
  try {
    known->set(result.options, value);
  } catch (const std::invalid_argument& error) {
    refuse(name, text_of(value), error.what());
  }
  if (!known->without_effect.empty()) {
    result.warnings.push_back("parameter ~" + name + " has no effect: " + known->without_effect);
  }
}

std::vector<Parameter> make_parameters() {
  const std::string rebuild_reason = "a broken branch always makes the root build the tree anew";
  const std::string recursive_reason = "a robot always acknowledges a group packet when all behind it have it";
  const std::string nack_reason = "members report what they miss of group packets of every size";
  const std::string relaying_reason =
      "the hop-by-hop resends and the routes found anew do what cooperative relaying was meant for";
  return {
      stored(
          "interface", [](NodeOptions & o) -> auto& { return o.interface; }),
      parsed<std::string>("mac", "",
                          [](NodeOptions& o, const std::string& text) {
                            o.mac.reset();
                            if (!text.empty()) o.mac = parse_mac_address(text);
                          }),
      stored(
          "robot_name", [](NodeOptions & o) -> auto& { return o.engine.robot_name; }),
      stored(
          "num_link_retrans", [](NodeOptions & o) -> auto& { return o.engine.num_link_retrans; }),
      stored(
          "num_e2e_retrans", [](NodeOptions & o) -> auto& { return o.engine.num_e2e_retrans; }),
      stored(
          "num_rreq", [](NodeOptions & o) -> auto& { return o.engine.num_rreq; }),
      stored(
          "max_frame_size", [](NodeOptions & o) -> auto& { return o.engine.max_frame_size; }),
      stored(
          "hop_limit_min", [](NodeOptions & o) -> auto& { return o.engine.hop_limit_min; }),
      stored(
          "hop_limit_max", [](NodeOptions & o) -> auto& { return o.engine.hop_limit_max; }),
      stored(
          "hop_limit_increment", [](NodeOptions & o) -> auto& { return o.engine.hop_limit_increment; }),
      parsed<int>("beacon_interval", static_cast<int>(EngineOptions().beacon_interval.count()),
                  [](NodeOptions& o, int value) { o.engine.beacon_interval = std::chrono::milliseconds(value); }),
      {"timings", "struct", "robots", "",
       [](NodeOptions& o, const XmlRpcValue& value) { o.engine.timings = parse_timings(value); }},
      parsed<int>("max_packet_size", static_cast<int>(EngineOptions().max_packet_size), set_packet_size),
      stored(
          "simulation_mode", [](NodeOptions & o) -> auto& { return o.simulation_mode; }),
      stored(
          "robots_in_simulation", [](NodeOptions & o) -> auto& { return o.robots_in_simulation; }),
      stored(
          "p_thres", [](NodeOptions & o) -> auto& { return o.channel.p_thres; }),
      stored(
          "p_tx", [](NodeOptions & o) -> auto& { return o.channel.p_tx; }),
      stored(
          "n_model", [](NodeOptions & o) -> auto& { return o.channel.n_model; }),
      stored(
          "l_0_model", [](NodeOptions & o) -> auto& { return o.channel.l_0_model; }),
      stored(
          "topic_new_robot", [](NodeOptions & o) -> auto& { return o.topic_new_robot; }),
      stored(
          "topic_remove_robot", [](NodeOptions & o) -> auto& { return o.topic_remove_robot; }),
      checked_without_effect(
          "rebuild_mc_tree", rebuild_reason, [](NodeOptions & o) -> auto& { return o.engine.rebuild_mc_tree; }),
      checked_without_effect(
          "recursive_mc_ack", recursive_reason, [](NodeOptions & o) -> auto& { return o.engine.recursive_mc_ack; }),
      stored(
          "loss_ratio", [](NodeOptions & o) -> auto& { return o.engine.loss_ratio; }),
      checked_without_effect(
          "nack_threshold", nack_reason, [](NodeOptions & o) -> auto& { return o.engine.nack_threshold; }),
      parsed<std::string>("sim_robot_macs", "",
                          [](NodeOptions& o, const std::string& text) { o.sim_robot_macs = parse_robot_macs(text); }),
      stored(
          "log_path", [](NodeOptions & o) -> auto& { return o.log_path; }),
      stored(
          "join_groups_automatically", [](NodeOptions & o) -> auto& { return o.engine.join_groups_automatically; }),
      stored(
          "key_file", [](NodeOptions & o) -> auto& { return o.key_file; }),
      stored(
          "require_key", [](NodeOptions & o) -> auto& { return o.require_key; }),
      stored(
          "inject_allow", [](NodeOptions & o) -> auto& { return o.inject_allow; }),
      stored(
          "inject_deny", [](NodeOptions & o) -> auto& { return o.inject_deny; }),
      stored(
          "send_lifetime", [](NodeOptions & o) -> auto& { return o.send_lifetime; }),
      stored(
          "newest_only", [](NodeOptions & o) -> auto& { return o.newest_only; }),
      {"relay", "list", "[]", "", [](NodeOptions& o, const XmlRpcValue& value) { o.relays = parse_relays(value); }},
      stored(
          "capture_file", [](NodeOptions & o) -> auto& { return o.capture_file; }),
      stored(
          "capture_size", [](NodeOptions & o) -> auto& { return o.capture_size; }),
      without_effect("enable_cooperative_relaying", "bool", "true", relaying_reason),
      without_effect("tx_power", "string", "", "the channel model and wireless interfaces take p_tx"),
      without_effect("use_sim_time", "bool", "false", "the protocol runs on the steady clock, never on ROS time"),
  };
}

}  // namespace

const std::vector<Parameter>& parameters() {
  static const std::vector<Parameter> list = make_parameters();
  return list;
}

std::map<MacAddress, std::string> parse_robot_macs(const std::string& text) {
  std::map<MacAddress, std::string> robots;
  std::istringstream entries(text);
  for (std::string entry; std::getline(entries, entry, '!');) {
    const auto comma = entry.find(',');
    if (comma == std::string::npos) throw std::invalid_argument("has the entry '" + entry + "', not name,mac!name,mac");
    const std::string name = entry.substr(0, comma);
    if (!is_robot_name(name)) throw std::invalid_argument("has the entry '" + entry + "' without a robot name");
    if (!robots.emplace(parse_mac_address(entry.substr(comma + 1)), name).second) {
      throw std::invalid_argument("has the address of '" + entry + "' twice");
    }
  }
  return robots;
}

OptionsRead read_options(const XmlRpcValue& values, const std::string& host_name) {
  OptionsRead result;
  XmlRpcValue copy(values);  // XmlRpcValue has no const iteration
  if (copy.getType() == XmlRpcValue::TypeStruct) {
    for (const auto& [name, value] : copy) read_one(name, value, result);
  } else if (copy.valid()) {
    throw std::invalid_argument("a parameter has the name of this node, where its own parameters have to be: it is " +
                                text_of(copy) + "; take it away with \"rosparam delete\", or rename the node");
  }
  complete(result.options, host_name);
  check(result.options);
  return result;
}

/// max_frame_size stays as it is: the interface may come back with a larger MTU.
std::optional<std::string> set_mtu(NodeOptions& options, int mtu) {
  options.engine.mtu = mtu;
  const int largest = mtu + static_cast<int>(kEthernetHeaderSize);
  const int wanted = options.engine.max_frame_size;
  if (wanted <= largest) return std::nullopt;
  return "parameter ~max_frame_size = " + std::to_string(wanted) + " is more than interface " + options.interface +
         " carries: " + std::to_string(largest) + " is used";
}

}  // namespace adhoc_communication
