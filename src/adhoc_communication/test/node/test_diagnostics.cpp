// What monitors are told.
#include <gtest/gtest.h>

#include <algorithm>

#include "node/diagnostics.hpp"

namespace adhoc_communication {
namespace {

using diagnostic_msgs::DiagnosticStatus;

NetworkState healthy_state() {
  NetworkState state;
  state.robot_name = "alice";
  state.interface = "wlan0";
  state.address = "02:00:00:00:00:01";
  state.interface_up = true;
  state.sealed = true;
  return state;
}

DiagnosticStatus part(const diagnostic_msgs::DiagnosticArray& array, const std::string& name) {
  const auto found = std::find_if(array.status.begin(), array.status.end(), [&](const DiagnosticStatus& status) {
    return status.name == "adhoc_communication alice: " + name;
  });
  EXPECT_NE(found, array.status.end()) << name;
  return found == array.status.end() ? DiagnosticStatus() : *found;
}

DiagnosticStatus part(const NetworkState& state, const std::string& name) {
  Diagnostics diagnostics;
  return part(diagnostics.report(state), name);
}

TEST(Diagnostics, AllIsWell) {
  Diagnostics diagnostics;
  const auto array = diagnostics.report(healthy_state());
  EXPECT_EQ(array.status.size(), 8u);
  for (const auto& status : array.status) {
    EXPECT_EQ(int{status.level}, int{DiagnosticStatus::OK}) << status.name << ": " << status.message;
    EXPECT_EQ(status.hardware_id, "02:00:00:00:00:01");
  }
}

TEST(Diagnostics, InterfaceDownIsAnErrorAndOpenFramesWarn) {
  NetworkState state = healthy_state();
  state.interface_up = false;
  state.sealed = false;
  EXPECT_EQ(int{part(state, "interface").level}, int{DiagnosticStatus::ERROR});
  EXPECT_EQ(part(state, "interface").message, "wlan0 is down");
  EXPECT_EQ(int{part(state, "security").level}, int{DiagnosticStatus::WARN});
}

TEST(Diagnostics, InterfaceThatRefusesFramesWarns) {
  NetworkState state = healthy_state();
  state.frames_not_sent = 3;
  const DiagnosticStatus status = part(state, "interface");
  EXPECT_EQ(int{status.level}, int{DiagnosticStatus::WARN});
  EXPECT_EQ(status.message, "wlan0 does not take all frames");
  ASSERT_FALSE(status.values.empty());
  EXPECT_EQ(status.values.back().key, "frames not sent");
  EXPECT_EQ(status.values.back().value, "3");
}

TEST(Diagnostics, MissedFramesAreAWarning) {
  NetworkState state = healthy_state();
  state.frames_missed = 2;
  const DiagnosticStatus status = part(state, "interface");
  EXPECT_EQ(int{status.level}, int{DiagnosticStatus::WARN});
  EXPECT_EQ(status.message, "frames came faster than this robot can take them");
}

TEST(Diagnostics, LossOfEachLinkIsTold) {
  NetworkState state = healthy_state();
  state.links.resize(2);
  state.links[0].robot = "bob";
  state.links[0].two_way = true;
  state.links[0].loss = 0.25f;
  state.links[1].address = "02:00:00:00:00:03";
  const DiagnosticStatus status = part(state, "neighbors");
  EXPECT_EQ(int{status.level}, int{DiagnosticStatus::WARN});
  EXPECT_EQ(status.message, "02:00:00:00:00:03 does not hear this robot");
  ASSERT_EQ(status.values.size(), 2u);
  EXPECT_EQ(status.values[0].key, "loss to bob");
  EXPECT_EQ(status.values[0].value, "25 %");
}

TEST(Diagnostics, AnotherRobotOfTheOwnNameIsAnError) {
  NetworkState state = healthy_state();
  state.robots = {"alice", "bob"};
  const DiagnosticStatus status = part(state, "neighbors");
  EXPECT_EQ(int{status.level}, int{DiagnosticStatus::ERROR});
  EXPECT_EQ(status.message, "two robots are called alice: give each its own ~robot_name");
}

TEST(Diagnostics, LossesWarnWhileTheyGrowAndSomeTimeAfter) {
  Diagnostics diagnostics;
  NetworkState state = healthy_state();
  state.log_rows_lost = 5;
  for (int i = 0; i < Diagnostics::kReportsAfterLoss; ++i) {
    EXPECT_EQ(int{part(diagnostics.report(state), "files").level}, int{DiagnosticStatus::WARN}) << i;
  }
  EXPECT_EQ(int{part(diagnostics.report(state), "files").level}, int{DiagnosticStatus::OK});
  state.frames_not_captured = 1;
  EXPECT_EQ(int{part(diagnostics.report(state), "files").level}, int{DiagnosticStatus::WARN});
}

TEST(Diagnostics, RefusedFramesAreTotalledByReason) {
  NetworkState state = healthy_state();
  state.frames_replayed = 7;
  const DiagnosticStatus status = part(state, "dropped frames");
  EXPECT_EQ(int{status.level}, int{DiagnosticStatus::WARN});
  EXPECT_EQ(status.message, "frames are refused: replayed");
  EXPECT_EQ(status.values.size(), 7u);
  EXPECT_EQ(int{part(state, "security").level}, int{DiagnosticStatus::WARN});
  NetworkState start = healthy_state();
  start.frames_unproven = 3;
  EXPECT_EQ(int{part(start, "dropped frames").level}, int{DiagnosticStatus::OK});
}

TEST(Diagnostics, RelayThatDropsOrFailsIsNamed) {
  NetworkState state = healthy_state();
  state.relays.resize(1);
  state.relays[0].topic = "scan";
  state.relays[0].destination = "bob";
  EXPECT_EQ(int{part(state, "relays").level}, int{DiagnosticStatus::OK});
  state.relays[0].dropped = 2;
  EXPECT_EQ(part(state, "relays").message, "scan to bob: messages are dropped");
  state.relays[0].dropped = 0;
  state.relays[0].failed = 1;
  state.relays[0].last_failure = "no route to bob after 1.8 s";
  EXPECT_EQ(part(state, "relays").message, "scan to bob: no route to bob after 1.8 s");
}

TEST(Diagnostics, FullQueueAndUnpublishedPacketsWarn) {
  NetworkState state = healthy_state();
  state.packets_waiting = 250;
  state.packets_not_published = 1;
  EXPECT_EQ(int{part(state, "queues").level}, int{DiagnosticStatus::WARN});
  EXPECT_EQ(int{part(state, "publishing").level}, int{DiagnosticStatus::WARN});
}

}  // namespace
}  // namespace adhoc_communication
