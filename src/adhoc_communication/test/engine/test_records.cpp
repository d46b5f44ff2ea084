// What hosts may write down of single frames and searches.
#include <gtest/gtest.h>

#include <algorithm>

#include "api/journal.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kData = 6;  // docs/protocol.md
constexpr std::size_t kGroupData = 12;

template <typename Kind>
std::vector<Kind> of_kind(const std::vector<Record>& records) {
  std::vector<Kind> result;
  for (const Record& record : records) {
    if (const auto* what = std::get_if<Kind>(&record.what)) result.push_back(*what);
  }
  return result;
}

/// Robots in a row, which tell everything.
struct Row {
  explicit Row(std::size_t robots, double loss = 0.0) : team(medium(loss), 3) {
    EngineOptions options;
    options.keep_records = true;
    options.join_groups_automatically = false;
    team.add_line(robots, options);
    team.run_for(1s);
  }
  static MediumOptions medium(double loss) {
    MediumOptions options;
    options.loss = loss;
    return options;
  }
  bool deliver(const std::string& destination, std::size_t octets) {
    const SendId id = team.send(0, destination, noise(octets));
    return team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s) && team.finished(0, id)->delivered;
  }

  Team team;
};

TEST(Records, ASearchIsToldWhereItBeganWhereItPassedAndWhereItEnded) {
  Row row(3);
  for (std::size_t robot = 0; robot < 3; ++robot) row.team.engine(robot).take_records();
  ASSERT_TRUE(row.deliver("robot_2", 100));
  const auto searches = of_kind<SearchEnded>(row.team.engine(0).take_records());
  ASSERT_EQ(searches.size(), 1u);
  EXPECT_EQ(searches[0].destination, "robot_2");
  EXPECT_EQ(searches[0].requests, 1);
  EXPECT_GE(searches[0].replies, 1);
  EXPECT_GT(searches[0].ended, searches[0].began);
  EXPECT_EQ(searches[0].route.hops, 2);
  EXPECT_EQ(searches[0].route.next_hop, Team::address(1));
  EXPECT_EQ(searches[0].route.destination, Team::address(2));
  const auto passed_on = of_kind<RequestPassedOn>(row.team.engine(1).take_records());
  ASSERT_EQ(passed_on.size(), 1u);
  EXPECT_EQ(passed_on[0].request, searches[0].request);
  EXPECT_EQ(passed_on[0].originator, "robot_0");
  EXPECT_EQ(passed_on[0].from, Team::address(0));
  const auto arrived = of_kind<RequestArrived>(row.team.engine(2).take_records());
  ASSERT_GE(arrived.size(), 1u);
  EXPECT_EQ(arrived[0].request, searches[0].request);
  EXPECT_EQ(arrived[0].originator, "robot_0");
  EXPECT_EQ(arrived[0].copies, 1);
  EXPECT_TRUE(arrived[0].answered);
  EXPECT_EQ(arrived[0].back.hops, 2);
  EXPECT_EQ(arrived[0].back.next_hop, Team::address(1));
  EXPECT_EQ(arrived[0].back.destination, Team::address(0));
}

TEST(Records, ASearchThatFailsHasNoRoute) {
  Row row(1);
  EXPECT_FALSE(row.deliver("nobody", 100));
  const auto searches = of_kind<SearchEnded>(row.team.engine(0).take_records());
  ASSERT_EQ(searches.size(), 1u);
  EXPECT_EQ(searches[0].destination, "nobody");
  EXPECT_GE(searches[0].requests, 2);
  EXPECT_EQ(searches[0].replies, 0);
  EXPECT_EQ(searches[0].route.hops, 0);
}

TEST(Records, EachFrameOfAPacketEndsOnceAndIsAcknowledgedOnTheHop) {
  Row row(3, 0.2);
  ASSERT_TRUE(row.deliver("robot_2", 50'000));
  const auto records = row.team.engine(0).take_records();
  auto segments = of_kind<SegmentEnded>(records);
  ASSERT_GE(segments.size(), 35u);
  std::sort(segments.begin(), segments.end(), [](const auto& a, const auto& b) { return a.index < b.index; });
  for (std::size_t i = 0; i < segments.size(); ++i) {
    EXPECT_EQ(segments[i].index, i);
    EXPECT_EQ(segments[i].destination, "robot_2");
    EXPECT_TRUE(segments[i].delivered);
    EXPECT_GT(segments[i].ended, segments[i].sent);
    EXPECT_EQ(segments[i].route.hops, 2);
  }
  const auto frames = of_kind<FramePassed>(records);
  EXPECT_GE(frames.size(), segments.size());
  EXPECT_TRUE(std::any_of(frames.begin(), frames.end(), [](const auto& frame) { return frame.repetitions > 0; }));
  for (const FramePassed& frame : frames) {
    EXPECT_EQ(frame.source, "robot_0");
    EXPECT_EQ(frame.sender, Team::address(0));
    EXPECT_EQ(frame.neighbor, Team::address(1));
    EXPECT_GT(frame.acknowledged, frame.sent);
  }
  const auto relayed = of_kind<FramePassed>(row.team.engine(1).take_records());
  EXPECT_TRUE(std::any_of(relayed.begin(), relayed.end(), [](const auto& frame) {
    return frame.source == "robot_0" && frame.neighbor == Team::address(2);
  }));
}

TEST(Records, FramesOfAPacketGivenUpAreNotDelivered) {
  Row row(2);
  ASSERT_TRUE(row.deliver("robot_1", 100));
  row.team.engine(0).take_records();
  row.team.kill(1);
  EXPECT_FALSE(row.deliver("robot_1", 3000));
  const auto segments = of_kind<SegmentEnded>(row.team.engine(0).take_records());
  ASSERT_EQ(segments.size(), 3u);
  for (const SegmentEnded& segment : segments) EXPECT_FALSE(segment.delivered);
}

TEST(Records, CountersTellOwnFramesFromThoseOfOthers) {
  Row row(3, 0.2);
  ASSERT_TRUE(row.deliver("robot_2", 900'000));
  const DataFrames source = row.team.engine(0).statistics().unicast_data;
  const DataFrames relay = row.team.engine(1).statistics().unicast_data;
  EXPECT_GE(source.sent, 35u);
  EXPECT_GT(source.sent_again, 0u);
  EXPECT_EQ(source.passed_on, 0u);
  EXPECT_EQ(relay.sent, 0u);
  EXPECT_GE(relay.passed_on, source.sent);
  EXPECT_GT(relay.passed_on_again, 0u);
  EXPECT_EQ(relay.received, relay.passed_on);
  EXPECT_GE(row.team.engine(2).statistics().unicast_data.received, source.sent);
  EXPECT_GT(row.team.engine(1).statistics().frames_received_again, 0u);
  const Statistics& statistics = row.team.engine(0).statistics();
  EXPECT_EQ(statistics.frames_sent_by_type[kData], source.sent + source.sent_again);
  EXPECT_GT(statistics.bytes_sent_by_type[kData], 1000 * source.sent);
}

TEST(Records, GroupFramesAreCountedByThemselves) {
  MediumOptions medium;
  medium.loss = 0.2;
  Team team(medium, 4);
  team.add_line(3);
  team.run_for(3s);
  const SendId id = team.send(0, "mc_robot_0", noise(50'000));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s));
  const DataFrames source = team.engine(0).statistics().group_data;
  const DataFrames relay = team.engine(1).statistics().group_data;
  EXPECT_GE(source.sent, 35u);
  EXPECT_GT(source.sent_again, 0u);
  EXPECT_EQ(source.passed_on, 0u);
  EXPECT_EQ(relay.sent, 0u);
  EXPECT_GE(relay.passed_on, 35u);
  EXPECT_GE(relay.received, 35u);
  EXPECT_LE(relay.received, team.engine(1).statistics().frames_received_by_type[kGroupData]);
}

TEST(Records, WhoDoesNotAskForThemGetsNone) {
  Team team;
  team.add_line(2);
  team.run_for(1s);
  const SendId id = team.send(0, "robot_1", noise(10'000));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 10s));
  EXPECT_TRUE(team.engine(0).take_records().empty());
}

TEST(Records, AHostThatDoesNotTakeThemLosesTheRest) {
  Row row(2);
  ASSERT_TRUE(row.deliver("robot_1", 6'000'000));
  EXPECT_EQ(row.team.engine(0).take_records().size(), Journal::kMostRecords);
  EXPECT_GT(row.team.engine(0).statistics().records_lost, 1000u);
}

}  // namespace
}  // namespace adhoc_communication
