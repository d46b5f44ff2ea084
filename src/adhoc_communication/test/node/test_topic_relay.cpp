// Relays of a node whose ROS master does not answer.
#include <gtest/gtest.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/node_handle.h>
#include <topic_tools/shape_shifter.h>

#include <stdexcept>

#include "node/topic_relay.hpp"

namespace adhoc_communication {
namespace {

std::string complaint_of_adding(TopicRelay& relay, const RelayEntry& entry) {
  try {
    relay.add(entry);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// The relay was listed, carried nothing and could not be added again.
TEST(TopicRelay, WithoutAMasterNoRelayIsAddedAndItIsSaid) {
  const std::map<std::string, std::string> nobody = {{"__master", "http://localhost:1"}, {"__name", "test"}};
  ros::init(nobody, "test", ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  ros::master::setRetryTimeout(ros::WallDuration(0.1));
  TopicRelay relay(ros::NodeHandle(), "", "alice", 100'000);
  RelayEntry entry;
  entry.topic = "scan";
  entry.destination = "bob";
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(complaint_of_adding(relay, entry), "relay of 'scan': the ROS master does not answer");
    EXPECT_TRUE(relay.reports().empty());
  }
}

}  // namespace
}  // namespace adhoc_communication
