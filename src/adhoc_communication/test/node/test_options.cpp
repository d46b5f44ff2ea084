// Every parameter: accepted with its type, refused with a sentence that names it.
#include <gtest/gtest.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "node/options.hpp"

namespace adhoc_communication {
namespace {

using XmlRpc::XmlRpcValue;

NodeOptions read(const XmlRpcValue& values) { return read_options(values, "marley").options; }

std::string refusal_of(const XmlRpcValue& values) {
  try {
    read_options(values, "marley");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

template <typename Value>
XmlRpcValue with(const std::string& name, const Value& value) {
  XmlRpcValue values;
  values[name] = value;
  return values;
}

TEST(Options, NoParametersMeanDefaultsAndTheHostName) {
  const NodeOptions options = read(XmlRpcValue());
  EXPECT_EQ(options.engine.robot_name, "marley");
  EXPECT_EQ(options.interface, "wlan0");
  EXPECT_FALSE(options.mac);
}

TEST(Options, FilesMayLieBelowTheHomeFolder) {
  const std::string before = getenv("HOME") == nullptr ? "" : getenv("HOME");
  setenv("HOME", "/home/marley", 1);
  XmlRpcValue values = with("log_path", "~/logs");
  values["key_file"] = "~/team.key";
  values["capture_file"] = "~other/x.pcap";
  const NodeOptions options = read(values);
  setenv("HOME", before.c_str(), 1);
  EXPECT_EQ(options.log_path, "/home/marley/logs");
  EXPECT_EQ(options.key_file, "/home/marley/team.key");
  EXPECT_EQ(options.capture_file, "~other/x.pcap");
}

TEST(Options, AParameterInThePlaceOfThoseOfTheNodeIsRefused) {
  EXPECT_NE(refusal_of(XmlRpcValue(5)).find("a parameter has the name of this node"), std::string::npos);
}

TEST(Options, ContractHasTheseDefaults) {
  const std::map<std::string, std::string> expected = {{"interface", "wlan0"},
                                                       {"mac", ""},
                                                       {"robot_name", ""},
                                                       {"num_link_retrans", "10"},
                                                       {"num_e2e_retrans", "10"},
                                                       {"num_rreq", "1"},
                                                       {"max_frame_size", "1500"},
                                                       {"hop_limit_min", "0"},
                                                       {"hop_limit_max", "0"},
                                                       {"hop_limit_increment", "3"},
                                                       {"beacon_interval", "250"},
                                                       {"max_packet_size", "10000000"},
                                                       {"simulation_mode", "false"},
                                                       {"robots_in_simulation", "10"},
                                                       {"p_thres", "-75"},
                                                       {"p_tx", "15"},
                                                       {"n_model", "4"},
                                                       {"l_0_model", "33"},
                                                       {"topic_new_robot", "new_robot"},
                                                       {"topic_remove_robot", "remove_robot"},
                                                       {"rebuild_mc_tree", "false"},
                                                       {"recursive_mc_ack", "false"},
                                                       {"loss_ratio", "0"},
                                                       {"nack_threshold", "10"},
                                                       {"sim_robot_macs", ""}};
  for (const auto& [name, value] : expected) {
    const auto found = std::find_if(parameters().begin(), parameters().end(),
                                    [&name = name](const Parameter& parameter) { return parameter.name == name; });
    ASSERT_NE(found, parameters().end()) << name;
    EXPECT_EQ(found->default_value, value) << name;
    const bool belongs_to_trees = name == "rebuild_mc_tree" || name == "recursive_mc_ack" || name == "nack_threshold";
    EXPECT_EQ(found->without_effect.empty(), !belongs_to_trees) << name;
  }
}

TEST(Options, EachParameterReachesItsOption) {
  EXPECT_EQ(read(with("robot_name", "bob")).engine.robot_name, "bob");
  EXPECT_EQ(read(with("interface", "hub:/tmp/x")).interface, "hub:/tmp/x");
  EXPECT_EQ(read(with("num_link_retrans", 3)).engine.num_link_retrans, 3);
  EXPECT_EQ(read(with("num_e2e_retrans", 4)).engine.num_e2e_retrans, 4);
  EXPECT_EQ(read(with("num_rreq", 2)).engine.num_rreq, 2);
  EXPECT_EQ(read(with("send_lifetime", 1.5)).send_lifetime, 1.5);
  EXPECT_EQ(read(with("newest_only", "position scan*")).newest_only, "position scan*");
  EXPECT_EQ(read(with("max_frame_size", 1000)).engine.max_frame_size, 1000);
  EXPECT_EQ(read(with("hop_limit_increment", 2)).engine.hop_limit_increment, 2);
  EXPECT_EQ(read(with("beacon_interval", 100)).engine.beacon_interval, std::chrono::milliseconds(100));
  EXPECT_EQ(read(with("max_packet_size", 20000)).engine.max_packet_size, 20000u);
  EXPECT_EQ(read(with("robots_in_simulation", 3)).robots_in_simulation, 3);
  EXPECT_EQ(read(with("p_thres", -80)).channel.p_thres, -80);
  EXPECT_EQ(read(with("p_tx", 1)).channel.p_tx, 1);
  EXPECT_EQ(read(with("n_model", 2)).channel.n_model, 2);
  EXPECT_EQ(read(with("l_0_model", 40)).channel.l_0_model, 40);
  EXPECT_EQ(read(with("topic_new_robot", "arrived")).topic_new_robot, "arrived");
  EXPECT_EQ(read(with("topic_remove_robot", "left")).topic_remove_robot, "left");
  EXPECT_TRUE(read(with("rebuild_mc_tree", true)).engine.rebuild_mc_tree);
  EXPECT_TRUE(read(with("recursive_mc_ack", true)).engine.recursive_mc_ack);
  EXPECT_DOUBLE_EQ(read(with("loss_ratio", 0.25)).engine.loss_ratio, 0.25);
  EXPECT_EQ(read(with("nack_threshold", 5)).engine.nack_threshold, 5);
  EXPECT_EQ(read(with("log_path", "/tmp")).log_path, "/tmp");
  EXPECT_EQ(read(with("key_file", "/etc/team.key")).key_file, "/etc/team.key");
  EXPECT_EQ(read(with("inject_allow", "/map_*")).inject_allow, "/map_*");
  EXPECT_EQ(read(with("inject_deny", "/cmd_vel")).inject_deny, "/cmd_vel");
  EXPECT_NE(refusal_of(with("require_key", true)).find("key_file"), std::string::npos);
  EXPECT_FALSE(read(with("join_groups_automatically", false)).engine.join_groups_automatically);
}

/// The MTU of the start bounded frames for good.
TEST(Options, SmallMtuAtTheStartLeavesTheFrameSizeThatWasAskedFor) {
  NodeOptions options = read(with("max_frame_size", 1400));
  EXPECT_EQ(set_mtu(options, 1000),
            "parameter ~max_frame_size = 1400 is more than interface wlan0 carries: 1014 is used");
  EXPECT_EQ(options.engine.mtu, 1000);
  EXPECT_EQ(options.engine.max_frame_size, 1400) << "the interface may come back with a larger MTU";
  EXPECT_EQ(set_mtu(options, 1386), std::nullopt);
  EXPECT_EQ(options.engine.mtu, 1386);
}

TEST(Options, WholeNumberServesAsANumber) { EXPECT_DOUBLE_EQ(read(with("loss_ratio", 0)).engine.loss_ratio, 0.0); }

TEST(Options, WrongTypeIsRefusedByName) {
  EXPECT_EQ(refusal_of(with("beacon_interval", "often")), "parameter ~beacon_interval = often is not an integer");
  EXPECT_EQ(refusal_of(with("robot_name", 7)), "parameter ~robot_name = 7 is not a string");
  EXPECT_EQ(refusal_of(with("rebuild_mc_tree", 1)), "parameter ~rebuild_mc_tree = 1 is not true or false");
  EXPECT_EQ(refusal_of(with("loss_ratio", "much")), "parameter ~loss_ratio = much is not a number");
}

TEST(Options, OutOfRangeIsRefusedByName) {
  const std::map<std::string, int> bad = {
      {"num_link_retrans", -1}, {"num_e2e_retrans", -1}, {"num_rreq", -1},
      {"max_frame_size", 10},   {"hop_limit_min", -1},   {"hop_limit_max", -1},
      {"beacon_interval", -5},  {"max_packet_size", 0},  {"nack_threshold", -1},
      {"loss_ratio", 2},        {"p_thres", 1000},       {"p_tx", 1000},
      {"n_model", -1},          {"l_0_model", -1},       {"robots_in_simulation", -1}};
  for (const auto& [name, value] : bad) {
    EXPECT_NE(refusal_of(with(name, value)).find(name), std::string::npos)
        << name << ": " << refusal_of(with(name, value));
  }
}

TEST(Options, SimulationModeNeedsANumberedRobot) {
  XmlRpcValue values = with("simulation_mode", true);
  values["robot_name"] = "bob";
  EXPECT_NE(refusal_of(values).find("robot_<integer>"), std::string::npos);
  values["robot_name"] = "robot_12";
  EXPECT_EQ(refusal_of(values), "");
}

TEST(Options, RobotNameIsChecked) {
  EXPECT_NE(refusal_of(with("robot_name", "bob marley")).find("robot_name"), std::string::npos);
  EXPECT_NE(refusal_of(with("robot_name", std::string(65, 'a'))).find("robot_name"), std::string::npos);
  EXPECT_NE(refusal_of(with("robot_name", "mc_bob")).find("'mc_bob' begins with mc_"), std::string::npos);
}

TEST(Options, RobotMacsFillNamesAndTheOwnAddress) {
  XmlRpcValue values = with("sim_robot_macs", "robot_0,02:00:00:00:00:01!robot_1,02:00:00:00:00:02");
  values["robot_name"] = "robot_1";
  const NodeOptions options = read(values);
  EXPECT_EQ(options.sim_robot_macs.size(), 2u);
  EXPECT_EQ(options.mac, (MacAddress{2, 0, 0, 0, 0, 2}));
}

TEST(Options, BadRobotMacsAreRefused) {
  for (const char* text : {"robot_0", "robot_0,02", ",02:00:00:00:00:01", "a,02:00:00:00:00:01!b,02:00:00:00:00:01"}) {
    EXPECT_NE(refusal_of(with("sim_robot_macs", text)).find("sim_robot_macs"), std::string::npos) << text;
  }
}

TEST(Options, A12_1_TimingsAreAPresetAndWhatDiffersFromIt) {
  using namespace std::chrono_literals;
  EXPECT_EQ(read(with("timings", "rfc3561")).engine.timings.node_traversal_time, 40ms);
  XmlRpcValue members;
  members["preset"] = "rfc3561";
  members["node_traversal_time"] = 10;
  members["net_diameter"] = 10;
  const Timings timings = read(with("timings", members)).engine.timings;
  EXPECT_EQ(timings.net_traversal_time(), 200ms);
  EXPECT_EQ(timings.request_retries, rfc3561_timings().request_retries);
  EXPECT_FALSE(timings.destination_only);
  members["destination_only"] = true;
  EXPECT_TRUE(read(with("timings", members)).engine.timings.destination_only);
}

TEST(Options, BadTimingsAreRefused) {
  EXPECT_EQ(refusal_of(with("timings", "slow")),
            "parameter ~timings = slow has the preset 'slow', not robots or rfc3561");
  EXPECT_NE(refusal_of(with("timings", 3)).find("is neither a preset nor a struct"), std::string::npos);
  XmlRpcValue flag;
  flag["destination_only"] = 1;
  EXPECT_NE(refusal_of(with("timings", flag)).find("has a destination_only that is not a bool"), std::string::npos);
  XmlRpcValue members;
  members["node_traversal"] = 10;
  EXPECT_NE(refusal_of(with("timings", members)).find("has the unknown member 'node_traversal'"), std::string::npos);
}

XmlRpcValue relay_of(const std::string& topic, const std::string& destination) {
  XmlRpcValue entry;
  entry["topic"] = topic;
  entry["destination"] = destination;
  return entry;
}

/// ~relay with this one entry.
XmlRpcValue with_relay(const XmlRpcValue& entry) {
  XmlRpcValue values;
  values["relay"][0] = entry;
  return values;
}

TEST(Options, RelaysAreRead) {
  XmlRpcValue values = with_relay(relay_of("scan", "bob"));
  values["relay"][1] = relay_of("/map", "mc_marley");
  values["relay"][1]["remote_topic"] = "marley/map";
  values["relay"][1]["priority"] = "bulk";
  values["relay"][1]["rate"] = 2;
  values["relay"][1]["latched"] = true;
  const auto relays = read(values).relays;
  ASSERT_EQ(relays.size(), 2u);
  EXPECT_EQ(relays[0].topic, "scan");
  EXPECT_EQ(relays[0].destination, "bob");
  EXPECT_EQ(relays[0].priority, Priority::kNormal);
  EXPECT_EQ(relays[0].rate, 0.0);
  EXPECT_FALSE(relays[0].latched);
  EXPECT_EQ(relays[1].remote_topic, "marley/map");
  EXPECT_EQ(relays[1].priority, Priority::kBulk);
  EXPECT_EQ(relays[1].rate, 2.0);
  EXPECT_TRUE(relays[1].latched);
}

std::string refusal_of_relay(const std::string& field, const XmlRpcValue& value) {
  XmlRpcValue entry = relay_of("scan", "bob");
  entry[field] = value;
  return refusal_of(with_relay(entry));
}

TEST(Options, BadRelaysAreRefusedWithTheField) {
  EXPECT_NE(refusal_of(with("relay", "scan")).find("is not a list"), std::string::npos);
  EXPECT_NE(refusal_of(with_relay(XmlRpcValue("scan"))).find("struct with topic and destination"), std::string::npos);
  EXPECT_NE(refusal_of_relay("topic", "not a topic").find("topic 'not a topic' is not a valid"), std::string::npos);
  EXPECT_NE(refusal_of_relay("topic", 1).find("has a topic that is not a string"), std::string::npos);
  EXPECT_NE(refusal_of_relay("remote_topic", "~own").find("topic '~own' is not a valid"), std::string::npos);
  EXPECT_NE(refusal_of_relay("priority", "urgent").find("priority 'urgent'"), std::string::npos);
  EXPECT_NE(refusal_of_relay("rate", "fast").find("has a rate that is not a number"), std::string::npos);
  EXPECT_NE(refusal_of_relay("rate", -1.0).find("rate outside"), std::string::npos);
  EXPECT_NE(refusal_of_relay("latched", 1).find("has a latched that is not true or false"), std::string::npos);
  EXPECT_NE(refusal_of_relay("lached", true).find("unknown field 'lached'"), std::string::npos);
  EXPECT_NE(refusal_of_relay("destination", "marley").find("goes to this robot itself"), std::string::npos);
  EXPECT_NE(refusal_of(with("capture_size", -1)).find("capture_size"), std::string::npos);
}

TEST(Options, WithoutEffectAndUnknownWarnOnce) {
  XmlRpcValue values = with("enable_cooperative_relaying", false);
  values["beacon_intervall"] = 100;
  const auto warnings = read_options(values, "marley").warnings;
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_EQ(warnings[0], "parameter ~beacon_intervall is unknown and has no effect");
  EXPECT_EQ(warnings[1].find("parameter ~enable_cooperative_relaying has no effect: "), 0u);
}

}  // namespace
}  // namespace adhoc_communication
