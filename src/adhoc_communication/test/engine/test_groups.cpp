// Groups mc_<robot>, broadcasts and floods.
#include <gtest/gtest.h>

#include "finish.hpp"
#include "host.hpp"
#include "simulation/team.hpp"
#include "transport/flood.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

bool finish_soon(Team& team, std::size_t robot, SendId id, Time patience = 20s) {
  return finish(team, robot, id, patience);
}

std::vector<std::string> members_of(Team& team, std::size_t root) {
  return team.engine(root).group_state("mc_" + Team::name(root)).members;
}

TEST(Groups, RobotsJoinByThemselvesAndEveryMemberReceives) {
  MediumOptions medium;
  medium.loss = 0.1;
  Team team(medium, 2);
  team.add_line(4);
  team.run_for(5s);
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members.size(), 3u);
  EXPECT_TRUE(team.engine(3).group_state("mc_robot_0").connected);
  const SendId id = team.send(0, "mc_robot_0", noise(20'000));
  ASSERT_TRUE(finish_soon(team, 0, id));
  EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  for (std::size_t robot = 1; robot < 4; ++robot) {
    ASSERT_EQ(team.received(robot).size(), 1u);
    EXPECT_EQ(team.received(robot)[0].packet.group, "mc_robot_0");
    EXPECT_EQ(team.received(robot)[0].packet.source, "robot_0");
  }
}

TEST(Groups, B9_3_MemberThatIsNotTheRootReachesAll) {
  Team team;
  team.add_line(3);
  team.run_for(5s);
  const SendId id = team.send(2, "mc_robot_0", text("from a member"));
  ASSERT_TRUE(finish_soon(team, 2, id));
  EXPECT_TRUE(team.finished(2, id)->delivered) << team.finished(2, id)->reason;
  EXPECT_EQ(team.received(0).size(), 1u);
  EXPECT_EQ(team.received(1).size(), 1u);
  EXPECT_TRUE(team.received(2).empty());
}

TEST(Groups, WithoutMembersSucceedsAtOnceAndWithoutMembershipFails) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add_line(2, options);
  team.run_for(1s);
  const SendId own = team.send(0, "mc_robot_0", text("x"));
  const SendId other = team.send(0, "mc_robot_1", text("x"));
  ASSERT_TRUE(finish_soon(team, 0, own, 10ms));
  EXPECT_TRUE(team.finished(0, own)->delivered);
  ASSERT_TRUE(finish_soon(team, 0, other, 10ms));
  EXPECT_EQ(team.finished(0, other)->reason, "this robot is not a member of mc_robot_1");
}

TEST(Groups, UnreachableMemberIsNamed) {
  Team team;
  team.add_line(3);
  team.run_for(3s);
  team.kill(2);
  const SendId id = team.send(0, "mc_robot_0", text("x"));
  ASSERT_TRUE(finish_soon(team, 0, id));
  EXPECT_FALSE(team.finished(0, id)->delivered);
  EXPECT_NE(team.finished(0, id)->reason.find("not delivered to robot_2 ("), std::string::npos)
      << team.finished(0, id)->reason;
  EXPECT_EQ(team.received(1).size(), 1u);
}

TEST(Groups, HostJoinsAndLeaves) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add_line(2, options);
  team.run_for(1s);
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  ASSERT_EQ(team.group_changes(1).size(), 1u);
  EXPECT_TRUE(team.group_changes(1)[0].succeeded) << team.group_changes(1)[0].reason;
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
  team.engine(1).leave_group("mc_robot_0", team.now());
  team.run_for(1s);
  EXPECT_TRUE(team.engine(0).group_state("mc_robot_0").members.empty());
  team.engine(1).join_group("mc_robot_8", team.now());
  team.run_for(3s);
  EXPECT_FALSE(team.group_changes(1).back().succeeded);
  EXPECT_EQ(team.group_changes(1).back().reason, "cannot join mc_robot_8: no route to robot_8 after 1.8 s");
}

TEST(Groups, WhatIsNoGroupIsNeitherJoinedNorLeft) {
  Team team;
  team.add_line(1);
  team.engine(0).join_group("", team.now());
  team.engine(0).leave_group("", team.now());
  team.engine(0).leave_group("mc\n", team.now());
  team.run_for(1s);
  ASSERT_EQ(team.group_changes(0).size(), 3u);
  for (const auto& change : team.group_changes(0)) EXPECT_FALSE(change.succeeded);
  EXPECT_EQ(team.group_changes(0)[0].reason, "'' is not the name of a group (mc_<robot>)");
  EXPECT_EQ(team.group_changes(0)[1].reason, "'' is not the name of a group (mc_<robot>)");
  EXPECT_EQ(team.group_changes(0)[2].reason, "'mc\\x0a' is not the name of a group (mc_<robot>)");
}

TEST(Groups, B10_2_RestartedRootGetsItsMembersBack) {
  Team team;
  team.add_line(3);
  team.run_for(3s);
  team.restart(0);
  team.run_for(5s);
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members.size(), 2u);
}

/// The new run was taken for the former one, and then left packets out that the root had told as delivered.
TEST(Groups, B10_2_ARestartedMemberIsNoneUntilItJoins) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add_line(2, options);
  team.run_for(1s);
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  ASSERT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
  team.restart(1);
  team.run_for(2s);
  EXPECT_TRUE(team.engine(0).group_state("mc_robot_0").members.empty());
}

/// In some of a hundred restarts the root took the join for one of the run before, and the member heard nothing more.
TEST(Groups, B10_2_ARestartedMemberIsOneAgainHoweverSoonItJoins) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    MediumOptions medium;
    medium.loss = 0.3;
    Team team(medium, seed);
    team.add_line(2);
    team.run_for(3s);
    team.kill(1);
    team.run_for(std::chrono::milliseconds(7 * seed));
    team.restart(1);
    for (int i = 0; i < 25; ++i) {
      team.send(0, "mc_robot_0", text("news"));
      team.run_for(200ms);
    }
    ASSERT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"}) << "seed " << seed;
  }
}

/// The root has lost the member, but the member has heard the root all the time and does not join anew.
TEST(Groups, AMemberLostByTheRootAloneStaysAMember) {
  Team team;
  team.add_line(2);
  team.run_for(3s);
  team.medium().set_one_way_loss(1, 0, 1.0);
  team.run_for(7s);
  ASSERT_TRUE(team.engine(0).group_state("mc_robot_0").members.empty());
  team.medium().set_one_way_loss(1, 0, std::nullopt);
  team.run_for(2s);
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
  ASSERT_TRUE(finish_soon(team, 0, team.send(0, "mc_robot_0", text("again"))));
  EXPECT_EQ(team.received(1).size(), 1u);
}

TEST(Groups, AnExplicitJoinOutlivesARestartOfTheRoot) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add_line(2, options);
  team.run_for(1s);
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  team.restart(0);
  team.run_for(5s);
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members, std::vector<std::string>{"robot_1"});
}

TEST(Groups, ALeaveOutOfReachArrivesLater) {
  Team team;
  team.add_line(2);
  team.run_for(3s);
  team.medium().set_link_loss(0, 1, 1.0);
  team.engine(1).leave_group("mc_robot_0", team.now());
  team.run_for(3s);
  team.medium().set_link_loss(0, 1, std::nullopt);
  team.run_for(5s);
  EXPECT_TRUE(team.engine(0).group_state("mc_robot_0").members.empty());
  ASSERT_TRUE(finish_soon(team, 0, team.send(0, "mc_robot_0", text("x"))));
  EXPECT_TRUE(team.received(1).empty());
}

TEST(Groups, LeavingEndsAJoinThatIsStillWaiting) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add(options);
  team.engine(0).join_group("mc_robot_8", team.now());
  team.engine(0).leave_group("mc_robot_8", team.now());
  team.run_for(10ms);
  ASSERT_EQ(team.group_changes(0).size(), 2u);
  EXPECT_TRUE(team.group_changes(0)[0].joined);
  EXPECT_FALSE(team.group_changes(0)[0].succeeded);
  EXPECT_TRUE(team.group_changes(0)[1].succeeded);
}

/// By itself the robot joined again as soon as it heard of the root anew.
TEST(Groups, AnExplicitLeaveLasts) {
  Team team;
  team.add_line(2);
  team.run_for(3s);
  team.engine(1).leave_group("mc_robot_0", team.now());
  team.run_for(1s);
  for (int i = 0; i < 2; ++i) {
    team.restart(0);
    team.run_for(10s);
    EXPECT_TRUE(members_of(team, 0).empty());
    EXPECT_FALSE(team.engine(1).group_state("mc_robot_0").member);
  }
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  EXPECT_TRUE(team.group_changes(1).back().succeeded);
  EXPECT_EQ(members_of(team, 0), std::vector<std::string>{"robot_1"});
}

TEST(Groups, AnExplicitJoinThatFailsIsOver) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  team.add_line(2, options);
  team.run_for(2s);
  team.kill(0);
  team.engine(1).join_group("mc_robot_0", team.now());
  team.run_for(8s);
  ASSERT_EQ(team.group_changes(1).size(), 1u);
  EXPECT_FALSE(team.group_changes(1)[0].succeeded);
  team.restart(0);
  team.run_for(10s);
  EXPECT_TRUE(members_of(team, 0).empty());
}

/// The one that is too many believed to be a member, and got nothing.
TEST(Groups, OneMemberTooManyIsToldSo) {
  EngineOptions options;
  options.join_groups_automatically = false;
  options.mtu = 400;
  options.max_frame_size = 414;
  Team team;
  for (std::size_t i = 0; i < 55; ++i) team.add(options);
  team.run_for(3s);
  for (std::size_t i = 1; i < 55; ++i) {
    team.engine(i).join_group("mc_robot_0", team.now());
    team.run_for(100ms);
  }
  team.run_for(1s);
  for (std::size_t i = 1; i < 54; ++i) {
    ASSERT_EQ(team.group_changes(i).size(), 1u) << i;
    EXPECT_TRUE(team.group_changes(i)[0].succeeded) << team.group_changes(i)[0].reason;
  }
  ASSERT_EQ(team.group_changes(54).size(), 1u);
  EXPECT_EQ(team.group_changes(54)[0].reason, "cannot join mc_robot_0: it is full (53 members)");
  EXPECT_FALSE(team.engine(54).group_state("mc_robot_0").member);
  ASSERT_TRUE(finish_soon(team, 0, team.send(0, "mc_robot_0", text("to all"))));
  for (std::size_t i = 1; i < 54; ++i) EXPECT_EQ(team.received(i).size(), 1u);
  EXPECT_TRUE(team.received(54).empty());
  team.engine(7).leave_group("mc_robot_0", team.now());
  team.run_for(1s);
  team.engine(54).join_group("mc_robot_0", team.now());
  team.run_for(1s);
  EXPECT_TRUE(team.group_changes(54).back().succeeded) << team.group_changes(54).back().reason;
}

TEST(Broadcast, OneHopIsSegmentedAndReportedAsSuccess) {
  Team team;
  team.add_line(3);
  team.run_for(1s);
  const Bytes payload = noise(10'000);
  const SendId id = team.send(1, "", payload);
  ASSERT_TRUE(finish_soon(team, 1, id));
  EXPECT_TRUE(team.finished(1, id)->delivered);
  team.run_for(100ms);
  ASSERT_EQ(team.received(0).size(), 1u);
  EXPECT_EQ(team.received(0)[0].packet.payload, payload);
  ASSERT_EQ(team.received(2).size(), 1u);
}

TEST(Flood, ReachesAsFarAsItsHopLimit) {
  Team team;
  team.add_line(5);
  team.run_for(1s);
  team.engine(0).broadcast({"topic", 'A', text("x"), 3}, team.now());
  team.run_for(1s);
  for (std::size_t robot = 1; robot <= 3; ++robot) {
    ASSERT_EQ(team.received(robot).size(), 1u);
    EXPECT_EQ(team.received(robot)[0].packet.hops, robot);
  }
  EXPECT_TRUE(team.received(4).empty());
  const SendId large = team.engine(0).broadcast({"topic", 'A', noise(5000), 3}, team.now());
  team.run_for(1ms);
  EXPECT_FALSE(team.finished(0, large)->delivered);
}

/// Somebody recorded it near another robot, and said it again a minute later.
TEST(Flood, IsTakenOnceHoweverLateACopyComes) {
  Stage stage;
  Host &a = stage.neighbor(1), &b = stage.neighbor(2);
  stage.run_for(500ms);
  wire::Flood flood;
  flood.source = kFar.address;
  flood.source_boot = kFar.boot();
  flood.source_name = kFar.name;
  flood.hop_limit = 3;
  flood.image = *transport::encode({transport::PacketKind::kUser, 'A', {}, "topic", text("x")});
  stage.say_octets(a, wire::FrameType::kFlood, wire::to_bytes(flood));
  stage.run_for(60s);
  stage.say_octets(b, wire::FrameType::kFlood, wire::to_bytes(flood));
  stage.run_for(1s);
  EXPECT_EQ(stage.team.received(0).size(), 1u);
  EXPECT_EQ(stage.count(wire::FrameType::kFlood), 1u) << "passed on";
}

/// Calls were refused while the radio was busy with those before.
TEST(Flood, WaitsForTheAir) {
  MediumOptions medium;
  medium.bit_rate = 1e6;
  Team team(medium);
  team.add_line(2);
  team.run_for(2s);
  std::vector<SendId> ids;
  for (std::size_t i = 0; i < transport::FloodRelay::kMostWaiting; ++i) {
    ids.push_back(team.broadcast(0, {"topic", 'A', noise(1200), 1}));
  }
  const SendId refused = team.broadcast(0, {"topic", 'A', noise(1200), 1});
  team.run_for(3s);
  for (const SendId id : ids) {
    ASSERT_NE(team.finished(0, id), nullptr);
    EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  }
  EXPECT_EQ(team.finished(0, refused)->reason, "64 broadcasts wait for the air already");
  EXPECT_EQ(team.received(1).size(), ids.size());
}

/// `send_lifetime` did nothing for them.
TEST(Flood, DoesNotWaitLongerThanItsLifetime) {
  MediumOptions medium;
  medium.bit_rate = 1e6;
  Team team(medium);
  team.add_line(2);
  team.run_for(2s);
  std::vector<SendId> ids;
  for (int i = 0; i < 40; ++i) {
    BroadcastRequest request{"topic", 'A', noise(1200), 1};
    request.lifetime = i % 2 == 0 ? 20ms : 0ms;
    ids.push_back(team.broadcast(0, std::move(request)));
  }
  BroadcastRequest never{"topic", 'A', noise(1200), 1};
  never.lifetime = -1ms;
  const SendId refused = team.broadcast(0, std::move(never));
  const Time begin = team.now();
  team.run_for(3s);
  std::size_t sent = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const SendFinished* end = team.finished(0, ids[i]);
    ASSERT_NE(end, nullptr);
    sent += end->delivered ? 1 : 0;
    if (i % 2 != 0) EXPECT_TRUE(end->delivered);
    if (!end->delivered) {
      EXPECT_EQ(end->reason, "not delivered within its lifetime of 0.02 s");
      EXPECT_EQ(team.finished_at(0, ids[i]) - begin, 20ms);
    }
  }
  EXPECT_TRUE(team.finished(0, ids.front())->delivered);
  EXPECT_FALSE(team.finished(0, ids[38])->delivered);
  EXPECT_EQ(team.received(1).size(), sent) << "nothing of the others goes out";
  EXPECT_EQ(team.finished(0, refused)->reason, "the lifetime is negative");
}

TEST(Groups, StateTellsTreeNeighboursAndMembersApart) {
  Team team;
  team.add_line(4);
  team.run_for(5s);
  const auto state = [&](std::size_t robot) { return team.engine(robot).group_state("mc_robot_0"); };
  EXPECT_EQ(state(0).members, (std::vector<std::string>{"robot_1", "robot_2", "robot_3"}));
  EXPECT_EQ(state(0).downlinks, std::vector<std::string>{"robot_1"}) << "before the first packet";
  ASSERT_TRUE(finish_soon(team, 0, team.send(0, "mc_robot_0", noise(20'000))));
  EXPECT_EQ(state(0).downlinks, std::vector<std::string>{"robot_1"});
  EXPECT_EQ(state(1).downlinks, std::vector<std::string>{"robot_2"});
  EXPECT_TRUE(state(3).downlinks.empty());
  EXPECT_TRUE(state(1).members.empty());
}

/// The first broadcasts of each priority carried the same number, and receivers took the second for a repetition.
TEST(Groups, BroadcastsOfDifferentPrioritiesAreToldApart) {
  Team team;
  team.add_line(2);
  team.run_for(500ms);
  team.send(0, "", noise(20'000, 1), Priority::kBulk);
  team.run_for(1ms);
  team.send(0, "", noise(20'000, 2), Priority::kControl);
  team.run_for(100ms);
  ASSERT_EQ(team.received(1).size(), 2u);
  EXPECT_EQ(team.received(1)[0].packet.payload, noise(20'000, 2));
  EXPECT_EQ(team.received(1)[1].packet.payload, noise(20'000, 1));
}

}  // namespace
}  // namespace adhoc_communication
