// Which names topics may have.
#include <gtest/gtest.h>

#include "relay/message.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {
namespace {

TEST(LocalTopic, PrefixOnlyInSimulationMode) {
  EXPECT_EQ(local_topic("", "frontiers"), "frontiers");
  EXPECT_EQ(local_topic("", "/frontiers"), "/frontiers");
  EXPECT_EQ(local_topic("/robot_1/", "frontiers"), "/robot_1/frontiers");
  EXPECT_EQ(local_topic("/robot_1/", "/frontiers"), "/robot_1/frontiers");
}

TEST(LocalTopic, OneTopicHasOneName) {
  EXPECT_EQ(local_topic("", "//map///tiles/"), "/map/tiles");
  EXPECT_EQ(local_topic("/robot_1/", "//map/"), "/robot_1/map");
}

TEST(LocalTopic, RefusesWhatIsNoTopicName) {
  for (const char* topic : {"", "~private", "with space", "1st", "a-b", "\xff", "/", "/1st/~x"}) {
    EXPECT_THROW(local_topic("", topic), PayloadError) << topic;
  }
}

}  // namespace
}  // namespace adhoc_communication
