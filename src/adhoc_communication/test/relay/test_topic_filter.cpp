#include <gtest/gtest.h>

#include "node/options.hpp"
#include "relay/topic_filter.hpp"

namespace adhoc_communication {
namespace {

/// Velocities, goals and poses from the air moved a robot unless its user had thought of forbidding them.
TEST(TopicFilter, ByDefaultWhatWouldTakeTheRobotOverIsRefused) {
  const NodeOptions defaults;
  const TopicFilter filter(defaults.inject_allow, defaults.inject_deny);
  for (const char* topic : {"/rosout", "/clock", "/tf", "/tf_static", "/cmd_vel", "/base/cmd_vel",
                            "/cmd_vel_mux/input/navi", "/mobile_base/commands/velocity", "/initialpose",
                            "/move_base_simple/goal", "/move_base/goal", "/diagnostics", "/ns/diagnostics"}) {
    EXPECT_FALSE(filter.admits(topic)) << topic;
  }
  for (const char* topic : {"/map_other", "/auction", "/tf_other", "/ns/tf", "/goals"}) {
    EXPECT_TRUE(filter.admits(topic)) << topic;
  }
}

TEST(TopicFilter, AllowsOnlyWhatIsNamed) {
  const TopicFilter filter("map_*, /control", "");
  EXPECT_TRUE(filter.admits("/map_other"));
  EXPECT_TRUE(filter.admits("/control"));
  EXPECT_FALSE(filter.admits("/cmd_vel"));
  EXPECT_FALSE(TopicFilter("", "").admits("/anything"));
}

TEST(TopicFilter, DenialGoesBeforePatterns) {
  const TopicFilter filter("* /cmd_*", "/cmd_vel");
  EXPECT_FALSE(filter.admits("/cmd_vel"));
  EXPECT_TRUE(filter.admits("/chat"));
}

TEST(TopicFilter, WhatIsAllowedByNameIsAdmitted) {
  TopicFilter filter("* /arm/cmd_vel", "*cmd_vel");
  EXPECT_TRUE(filter.admits("/arm/cmd_vel"));
  EXPECT_TRUE(filter.names("/arm/cmd_vel"));
  EXPECT_FALSE(filter.admits("/cmd_vel"));
  EXPECT_FALSE(filter.names("/cmd_vel"));
}

TEST(TopicFilter, WhatIsNeverAdmittedCannotBeAllowed) {
  TopicFilter filter("* adhoc_communication/new_robot", "");
  filter.never("adhoc_communication/*");
  EXPECT_FALSE(filter.admits("/adhoc_communication/new_robot"));
}

}  // namespace
}  // namespace adhoc_communication
