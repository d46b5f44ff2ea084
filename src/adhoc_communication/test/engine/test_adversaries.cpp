// Adversaries who know the tables and their bounds: in an open team anybody in range, in a sealed one a robot with the
// key, or somebody who plays back what he has recorded.
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>

#include "host.hpp"
#include "insider.hpp"
#include "multicast/groups.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using transport::PacketKind;

EngineOptions sealed() {
  EngineOptions options;
  options.keys = {TeamKey{7}};
  return options;
}

/// What each robot has been told, without its times.
std::vector<std::string> words(Team& team, std::size_t robot) {
  std::vector<std::string> result;
  for (const auto& item : team.presence(robot)) result.push_back(item.second);
  return result;
}

wire::Data segment_of(const transport::Image& image, const Host& destination, const Host& source,
                      std::uint32_t packet) {
  wire::Data data = data_for(destination, source, packet);
  data.total = static_cast<std::uint32_t>(image->size());
  data.segment_size = 2000;
  data.octets = *image;
  return data;
}

wire::Flood flood_of(const Host& source, const transport::Image& image, std::uint32_t id) {
  wire::Flood flood;
  flood.source = source.address;
  flood.source_boot = source.boot();
  flood.source_name = source.name;
  flood.id = id;
  flood.image = *image;
  return flood;
}

void say(Stage& stage, Host& host, const wire::Flood& flood) {
  stage.say_octets(host, wire::FrameType::kFlood, wire::to_bytes(flood));
  stage.run_for(1ms);
}

/// A bomb of zeros in one frame took ten megabytes.
TEST(Adversary, AFloodUnpacksToLittle) {
  Stage stage;
  Host& forger = stage.neighbor(1);
  stage.run_for(10ms);
  const auto zeros = [](std::size_t size) {
    return transport::encode({PacketKind::kUser, 'A', {}, "topic", Bytes(size)});
  };
  say(stage, forger, flood_of(forger, zeros(60'000), 1));
  EXPECT_EQ(stage.team.received(0).size(), 1u);
  say(stage, forger, flood_of(forger, zeros(9'000'000), 2));
  EXPECT_EQ(stage.team.received(0).size(), 1u);
  EXPECT_EQ(stage.malformed(), 1u);
}

/// Words on groups unpack where they arrive. What was allowed grew with the packet: ten megabytes of one of five.
TEST(Adversary, WordsOnGroupsUnpackToLittleHoweverLongTheyAre) {
  Stage stage;
  Host& forger = stage.neighbor(1);
  stage.run_for(10ms);
  std::uint32_t packet = 0;
  const auto say_copy = [&](std::size_t octets) {
    const transport::Image carried = transport::encode({PacketKind::kUser, 'A', "mc_host_1", "topic", noise(100)});
    Bytes payload = multicast::encode_copy({3, 1, carried});
    const Bytes rest = noise(octets / 2);
    payload.insert(payload.end(), rest.begin(), rest.end());
    payload.resize(octets);
    const transport::Image image = transport::encode({PacketKind::kGroupCopy, 0, "mc_host_1", {}, payload});
    ASSERT_LT(image->size(), 2 * octets / 3);
    ASSERT_GE(2 * image->size(), octets);
    wire::Data segment = segment_of(image, stage.self(), forger, ++packet);
    for (std::size_t begin = 0; begin < image->size(); begin += segment.segment_size, ++segment.index) {
      const std::size_t end = std::min<std::size_t>(image->size(), begin + segment.segment_size);
      segment.octets.assign(image->begin() + static_cast<std::ptrdiff_t>(begin),
                            image->begin() + static_cast<std::ptrdiff_t>(end));
      stage.say(forger, segment);
    }
  };
  say_copy(64'000);
  EXPECT_EQ(stage.malformed(), 0u);
  say_copy(64'001);
  EXPECT_EQ(stage.malformed(), 1u);
  say_copy(200'000);
  EXPECT_EQ(stage.malformed(), 2u);
}

/// Bombs that a host does not fetch in time filled its memory, 4096 of them; and each took the engine's time.
TEST(Adversary, WaitingPacketsAreBoundedByTheirOctets) {
  Stage stage;
  Host& forger = stage.neighbor(1);
  stage.run_for(10ms);
  const transport::Image bomb = transport::encode({PacketKind::kUser, 'A', {}, "topic", Bytes(9'000'000)});
  for (std::uint32_t packet = 1; packet <= 20; ++packet) {
    stage.say(forger, segment_of(bomb, stage.self(), forger, packet));
  }
  EXPECT_EQ(stage.node().queues().events, 20u);
  const std::vector<TableFill> tables = stage.node().tables();
  const auto octets = std::find_if(tables.begin(), tables.end(), [](const TableFill& table) {
    return std::string(table.table) == "octets of events";
  });
  EXPECT_LE(octets->size, 20'000u) << "they stay packed until somebody unpacks them";
  for (const TableFill& table : tables) EXPECT_LE(table.size, table.most) << table.table;
}

/// Anybody could end a membership in anybody's name by one frame.
TEST(Adversary, AFloodSaysNothingOfGroups) {
  Team team;
  team.add();
  team.add();
  team.run_for(3s);
  ASSERT_EQ(team.engine(0).group_state("mc_robot_0").members.size(), 1u);
  Host member = make_host(0);
  member.name = "robot_1";
  Host forger = make_host(5);
  for (const PacketKind kind : {PacketKind::kGroupLeave, PacketKind::kGroupJoin, PacketKind::kGroupMembers}) {
    const wire::Flood flood =
        flood_of(member, transport::encode({kind, 0, "mc_robot_0", {}, {}}), 1 + static_cast<int>(kind));
    wire::FrameHeader header;
    header.type = wire::FrameType::kFlood;
    header.sender = forger.address;
    header.boot_id = forger.boot_id;
    header.counter = ++forger.counter;
    header.next_hop = wire::kEverybody;
    team.engine(0).receive({wire::kEverybody, forger.address, wire::close_openly(header, wire::to_bytes(flood))},
                           team.now());
  }
  team.run_for(100ms);
  EXPECT_EQ(team.engine(0).group_state("mc_robot_0").members.size(), 1u);
  EXPECT_EQ(team.engine(0).statistics().frames_dropped.malformed, 3u);
}

TEST(Adversary, AFloodDoesNotRenameARobot) {
  Stage stage;
  Host& honest = stage.neighbor(1);
  stage.run_for(10ms);
  Host renamed = honest;
  renamed.name = "host_9";
  say(stage, honest, flood_of(renamed, transport::encode({PacketKind::kUser, 'A', {}, "topic", text("x")}), 1));
  EXPECT_TRUE(stage.team.received(0).empty());
}

/// They went to logs and terminals as they were.
TEST(Adversary, NamesWithControlCharactersAreMalformed) {
  Stage stage;
  Host forger = make_host(1);
  for (const std::string& name :
       {std::string("a\x1b[2J"), std::string("two words"), std::string("a\n"), std::string("\0a", 2)}) {
    forger.name = name;
    stage.beacon(forger);
  }
  stage.run_for(10ms);
  EXPECT_TRUE(stage.node().robots().empty());
  EXPECT_EQ(stage.malformed(), 4u);
}

/// One beacon that claims to hear thousands one by one made its sender's silence count for hours.
TEST(Adversary, WhatABeaconClaimsIsClamped) {
  Stage stage;
  Host& forger = stage.neighbor(1, false);
  wire::Beacon beacon;
  beacon.name = forger.name;
  beacon.heard_count = 65'535;
  beacon.heard.push_back({wire::neighbor_tag(stage.self().boot()), 0});
  beacon.interval_ms = 200;
  stage.say(forger, beacon);
  EXPECT_TRUE(stage.route(forger));
  stage.run_for(30s);
  EXPECT_FALSE(stage.route(forger));
}

/// Recorded runs filled the list of those to prove themselves, and newcomers were not named.
TEST(Adversary, RecordedRunsKeepNoNewcomerOut) {
  Team team;
  team.add(sealed());
  std::vector<Frame> recorded;
  {
    Team past({}, 99);  // of another boot id of robot_0
    for (int robot = 0; robot < 2; ++robot) past.add(sealed());
    past.on_transmission = [&](std::size_t sender, const Frame& frame) {
      if (sender == 1 && frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kBeacon))
        recorded.push_back(frame);
    };
    for (int run = 0; run < 60; ++run) {
      past.run_for(300ms);
      past.restart(1);
    }
  }
  ASSERT_GT(recorded.size(), 60u);
  const auto play_back = [&](Time duration) {
    for (const Time end = team.now() + duration; team.now() < end;) {
      for (const Frame& frame : recorded) team.engine(0).receive(frame, team.now());
      team.run_for(100ms);
    }
  };
  play_back(3s);
  EXPECT_TRUE(team.presence(0).empty());
  team.add(sealed());
  team.run_for(0s);
  play_back(1s);
  EXPECT_EQ(words(team, 0), std::vector<std::string>{"+robot_1"});
}

TEST(Adversary, AnInsiderDoesNotDeafenTheTeam) {
  Team team;
  team.add(sealed());
  team.add(sealed());
  team.run_for(2s);
  Insider insider(team, make_host(5), sealed().keys);
  insider.prove(0);
  Host displaced = make_host(0);
  displaced.address = Team::address(1);
  displaced.name = "robot_1";
  for (int i = 0; i < 50; ++i) {
    displaced.boot_id = {0x99, static_cast<std::uint8_t>(i)};
    displaced.sequence = 1000;
    insider.say(0, wire::FrameType::kRouteRequest,
                wire::to_bytes(request_for(make_host(8), displaced, static_cast<std::uint32_t>(i))));
    insider.say(0, wire::FrameType::kRouteReply, wire::to_bytes(reply_about(displaced, make_host(8))));
    team.run_for(50ms);
  }
  const SendId id = team.send(1, "robot_0", text("still here"));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(1, id) != nullptr; }, 1s));
  EXPECT_TRUE(team.finished(1, id)->delivered);
  EXPECT_EQ(words(team, 0), (std::vector<std::string>{"+robot_1", "+host_5"}));
}

/// A playback of everything, ever again, while the team works.
TEST(Adversary, PlaybackChangesNothingInASealedTeam) {
  Team team;
  for (int robot = 0; robot < 3; ++robot) team.add(sealed());
  std::vector<Frame> recorded;
  team.on_transmission = [&](std::size_t, const Frame& frame) { recorded.push_back(frame); };
  team.run_for(3s);
  team.on_transmission = nullptr;
  team.restart(1);
  team.run_for(1s);
  for (std::size_t robot = 0; robot < 3; ++robot) team.presence(robot).clear();
  std::vector<SendId> ids;
  for (int step = 0; step < 100; ++step) {
    for (std::size_t robot = 0; robot < 3; ++robot) {
      for (std::size_t i = step; i < recorded.size(); i += 20) team.engine(robot).receive(recorded[i], team.now());
    }
    ids.push_back(team.send(1, "robot_0", noise(3000)));
    team.run_for(20ms);
  }
  team.run_for(2s);
  for (const SendId id : ids) EXPECT_TRUE(team.finished(1, id) && team.finished(1, id)->delivered);
  for (std::size_t robot = 0; robot < 3; ++robot) EXPECT_TRUE(team.presence(robot).empty()) << robot;
}

/// What was sent to a robot before it restarted is genuine, and new to its present run.
TEST(Adversary, ARestartedRobotTakesNothingFromBefore) {
  Team team;
  for (int robot = 0; robot < 2; ++robot) team.add(sealed());
  team.run_for(2s);
  std::vector<Frame> recorded;
  team.on_transmission = [&](std::size_t, const Frame& frame) { recorded.push_back(frame); };
  const SendId id = team.send(0, "robot_1", text("go"));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 1s));
  team.on_transmission = nullptr;
  ASSERT_EQ(team.received(1).size(), 1u);
  team.restart(1);
  team.run_for(1s);
  ASSERT_EQ(team.engine(1).neighbors(), std::vector<std::string>{"robot_0"});
  for (const Frame& frame : recorded) team.engine(1).receive(frame, team.now());
  team.run_for(100ms);
  EXPECT_EQ(team.received(1).size(), 1u);
  EXPECT_GT(team.engine(1).statistics().frames_dropped.replayed, 0u);
  const SendId later = team.send(0, "robot_1", text("on"));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, later) != nullptr; }, 1s));
  EXPECT_TRUE(team.finished(0, later)->delivered);
}

}  // namespace
}  // namespace adhoc_communication
