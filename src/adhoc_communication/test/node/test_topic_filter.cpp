#include <gtest/gtest.h>

#include "node/options.hpp"
#include "node/topic_filter.hpp"

namespace adhoc_communication {
namespace {

TEST(TopicFilter, ByDefaultOnlyWhatWouldTakeTheRobotOverIsRefused) {
  const NodeOptions defaults;
  const TopicFilter filter(defaults.inject_allow, defaults.inject_deny);
  for (const char* topic : {"/rosout", "/clock", "/tf", "/tf_static"}) EXPECT_FALSE(filter.admits(topic)) << topic;
  for (const char* topic : {"/map_other", "/auction", "/tf_other", "/ns/tf"})
    EXPECT_TRUE(filter.admits(topic)) << topic;
}

TEST(TopicFilter, AllowsOnlyWhatIsNamed) {
  const TopicFilter filter("map_*, /control", "");
  EXPECT_TRUE(filter.admits("/map_other"));
  EXPECT_TRUE(filter.admits("/control"));
  EXPECT_FALSE(filter.admits("/cmd_vel"));
  EXPECT_FALSE(TopicFilter("", "").admits("/anything"));
}

TEST(TopicFilter, DenialGoesBeforePermission) {
  TopicFilter filter("*", "/cmd_vel");
  filter.deny("adhoc_communication/*");
  EXPECT_FALSE(filter.admits("/cmd_vel"));
  EXPECT_FALSE(filter.admits("/adhoc_communication/new_robot"));
  EXPECT_TRUE(filter.admits("/chat"));
}

}  // namespace
}  // namespace adhoc_communication
