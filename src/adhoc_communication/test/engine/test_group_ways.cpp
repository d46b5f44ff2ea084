// By which way a packet for a group reaches its members: who is whose child, what is heard before an activation comes,
// and how it is learned what a way costs.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "finish.hpp"
#include "host.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

// In 255ths: nobody would send a packet for one robot over such links; others would not even send one for many.
constexpr std::uint8_t kLossy = 191, kHopeless = 220;

/// A node between a, which is the root, and b and c.
struct Fork : Stage {
  Fork() : a(neighbor(1)), b(neighbor(2)), c(neighbor(3)) { run_for(50ms); }

  /// The beacon of a robot that names these besides the node.
  void beacon(Host& host, std::uint8_t loss, const std::vector<const Host*>& heard) {
    wire::Beacon beacon;
    beacon.sequence_number = host.sequence;
    beacon.alive = 1 + static_cast<std::uint32_t>(now() / 1s);
    beacon.number = ++host.beacons_said;
    beacon.name = host.name;
    beacon.heard.push_back({wire::neighbor_tag(self().boot()), loss});
    for (const Host* other : heard) beacon.heard.push_back({wire::neighbor_tag(other->boot()), 0});
    beacon.heard_count = static_cast<std::uint8_t>(beacon.heard.size());
    say(host, beacon);
    run_for(1ms);
  }
  void activate(const std::vector<MacAddress>& members) {
    say(a, wire::GroupActivation{a.address, a.boot(), 1, members}, self().address);
    run_for(5ms);
  }
  void refuse(Host& child, const std::vector<MacAddress>& members) {
    say(child, wire::GroupRefusal{a.address, a.boot(), 1, members}, self().address);
    run_for(5ms);
  }
  /// The children that were told of the member since forget().
  std::vector<MacAddress> told_of(const MacAddress& member) const {
    std::vector<MacAddress> result;
    for (const auto& activation : sent<wire::GroupActivation>()) {
      const auto& members = activation.message.members;
      if (std::count(members.begin(), members.end(), member) != 0) result.push_back(activation.to);
    }
    return result;
  }

  Host& a;
  Host& b;
  Host& c;
};

/// One frame that is a whole packet of the group.
wire::GroupData packet_for(const Host& root, const std::string& group) {
  const transport::Image image = transport::encode({transport::PacketKind::kUser, 'A', group, "topic", text("hello")});
  wire::GroupData data;
  data.root = root.address;
  data.root_boot = root.boot();
  data.round = data.packet = data.base = 1;
  data.total = static_cast<std::uint32_t>(image->size());
  data.segment_size = 1000;
  data.octets = *image;
  return data;
}

/// The node joins the group of a, which takes it in.
void join(Fork& fork) {
  fork.node().join_group("mc_" + fork.a.name, fork.now());
  fork.run_for(5ms);
  wire::TransportAcknowledgment acknowledgment = acknowledgment_of(fork.a, fork.self(), 2);
  acknowledgment.stream = static_cast<std::uint8_t>(Priority::kControl);
  fork.say(fork.a, acknowledgment, fork.self().address);
  fork.run_for(5ms);
}

wire::GroupData question_after(wire::GroupData data) {
  data.octets.clear();
  data.report = true;
  return data;
}

/// An activation may be lost some times, and a packet is half sent before the next one comes.
TEST(GroupWays, B9_1_AMemberTakesWhatItHearsBeforeItsActivation) {
  for (const bool member : {true, false}) {
    Fork fork;
    const wire::GroupData data = packet_for(fork.a, "mc_" + fork.a.name);
    if (member) join(fork);
    fork.say(fork.b, data);
    fork.run_for(5ms);
    EXPECT_EQ(fork.node().trees().size(), member ? 1u : 0u);
    EXPECT_TRUE(fork.team.received(0).empty()) << "what its order is, only a place tells";
    if (!member) continue;
    fork.activate({fork.self().address});
    fork.say(fork.a, question_after(data), fork.self().address);
    fork.run_for(5ms);
    const auto reports = fork.sent<wire::GroupReport>();
    ASSERT_FALSE(reports.empty());
    EXPECT_TRUE(reports.back().message.complete);
    EXPECT_EQ(fork.team.received(0).size(), 1u);
  }
}

/// One frame in the name of the root, with numbers far ahead, and nothing of the group was delivered any more.
TEST(GroupWays, NumbersHeardWithoutAPlaceDecideNothing) {
  Fork fork;
  join(fork);
  wire::GroupData forged = packet_for(fork.a, "mc_" + fork.a.name);
  for (const std::uint32_t number : {0x70000000u, 0xe0000000u, 0u}) {
    forged.packet = forged.base = number;
    fork.say(fork.b, forged);
  }
  fork.activate({fork.self().address});
  wire::GroupData data = packet_for(fork.a, "mc_" + fork.a.name);
  for (data.packet = data.base = 1; data.packet <= 20; ++data.packet, ++data.base) {
    fork.say(fork.a, data);
    fork.run_for(5ms);
  }
  EXPECT_EQ(fork.team.received(0).size(), 20u);
}

/// Somebody recorded it near another robot, and said it again when the tree was forgotten.
TEST(GroupWays, ARecordedPacketIsNotDeliveredAgain) {
  Team team;
  team.add_line(2);
  team.run_for(3s);
  std::vector<Frame> recorded;
  team.on_transmission = [&](std::size_t, const Frame& frame) {
    if (frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kGroupData)) recorded.push_back(frame);
  };
  ASSERT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", text("hello"))));
  ASSERT_FALSE(recorded.empty());
  team.on_transmission = nullptr;
  team.run_for(70s);
  ASSERT_TRUE(std::none_of(team.engine(1).trees().begin(), team.engine(1).trees().end(),
                           [](const TreeState& tree) { return tree.root == Team::address(0); }));
  for (const Frame& frame : recorded) team.engine(1).receive(frame, team.now());
  team.run_for(1s);
  EXPECT_EQ(team.received(1).size(), 1u);
}

/// Behind a relay: what the newcomer heard of the newest packet made it pass over all that the root held for it.
TEST(GroupWays, ANewcomerAmidPacketsGetsThoseThatAreHeldForIt) {
  MediumOptions medium;
  medium.shared = true;
  medium.loss = 0.1;
  medium.bit_rate = 6e6;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Team team(medium, seed);
    for (const auto& [x, y] : {std::pair(0.0, 0.0), {8.0, 0.0}, {15.0, 4.0}, {15.0, -4.0}}) team.add({}, x, y);
    const std::size_t newcomer = team.add(without_groups(), 16, 0);
    team.run_for(8s);
    int sent = 0;
    const auto send_for = [&](Time duration) {
      for (const Time end = team.now() + duration; team.now() < end; team.run_for(100ms)) {
        Bytes payload = noise(12'000);
        payload[0] = static_cast<std::uint8_t>(++sent);
        team.send(0, "mc_robot_0", payload);
      }
    };
    send_for(6s);
    const int held_from = sent - 40;  // of the last 5 s, those whose members all have them are gone
    team.engine(newcomer).join_group("mc_robot_0", team.now());
    send_for(4s);
    team.run_for(30s);
    std::set<int> got;
    for (const auto& received : team.received(newcomer)) got.insert(received.packet.payload[0]);
    for (int number = held_from; number <= sent; ++number) EXPECT_EQ(got.count(number), 1u) << number << ", " << seed;
  }
}

TEST(GroupWays, ARunOfTheRootThatIsNoMoreIsNotHeard) {
  Fork fork;
  const std::string group = "mc_" + fork.a.name;
  join(fork);
  wire::GroupData data = packet_for(fork.a, group);
  data.root_boot ^= 1;
  fork.say(fork.b, data);
  fork.run_for(5ms);
  EXPECT_TRUE(fork.team.received(0).empty());
  EXPECT_TRUE(fork.node().trees().empty());
}

TEST(GroupWays, AMemberInRangeIsAChildOfItsOwnThoughPacketsForItGoRound) {
  for (const std::uint8_t loss : {kLossy, kHopeless}) {
    Fork fork;
    Host member = make_host(4);
    fork.beacon(fork.c, 180, {});
    fork.give_route(fork.b, member);
    for (int i = 0; i < 20; ++i) fork.beacon(member, loss, {});
    ASSERT_EQ(fork.route(member)->next_hop, fork.b.address);
    fork.activate({fork.c.address, member.address});
    const auto told = fork.told_of(member.address);
    ASSERT_EQ(told.size(), 1u);
    EXPECT_EQ(told[0], loss == kLossy ? member.address : fork.b.address) << "of a link that is worse than both";
  }
}

TEST(GroupWays, WhoHearsAMemberIsTriedNext) {
  Fork fork;
  Host& d = fork.neighbor(5);
  fork.run_for(50ms);
  fork.give_route(fork.b, kFar);
  fork.activate({kFar.address, fork.b.address, fork.c.address, d.address});
  fork.beacon(d, 0, {&kFar});
  fork.forget();
  fork.refuse(fork.b, {kFar.address});
  EXPECT_EQ(fork.told_of(kFar.address), std::vector<MacAddress>{d.address}) << "not c, the first of the others";
}

/// Who hears the member and refuses it all the same has its place elsewhere: robots behind this one would only hand it
/// from one to the next.
TEST(GroupWays, WhatIsRefusedByWhoHearsTheMemberGoesBackUp) {
  Fork fork;
  fork.give_route(fork.b, kFar);
  fork.activate({kFar.address, fork.c.address});
  fork.beacon(fork.b, 0, {&kFar});
  fork.forget();
  fork.refuse(fork.b, {kFar.address});
  EXPECT_TRUE(fork.told_of(kFar.address).empty());
  const auto refusals = fork.sent<wire::GroupRefusal>();
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(refusals[0].to, fork.a.address);
}

/// Frames for everybody take ten times as long as those for both members. The few that are sent before that is known
/// are most of what is lost, so their cost is asked for until it is known, and answers to a trial are waited for.
TEST(GroupWays, FewFramesForEverybodyAreSentWhereTheyAreFarTooDear) {
  MediumOptions medium;
  medium.contention = true;
  medium.loss = 0.1;
  medium.rates.broadcast = 1e6;
  medium.rates.unicast = ofdm_rates();
  medium.rates.unicast_retries = 7;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Team team(medium, seed);
    team.add({}, 0, 0);
    for (const double side : {-1.0, 1.0}) team.add({}, 2 * side, 0);
    team.run_for(8s);
    int for_everybody = 0;
    team.on_transmission = [&](std::size_t robot, const Frame& frame) {
      const bool data = frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kGroupData);
      for_everybody += robot == 0 && data && frame.destination == wire::kEverybody;
    };
    ASSERT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(500'000), Priority::kBulk)));
    EXPECT_LE(for_everybody, 6) << "seed " << seed;
  }
}

}  // namespace
}  // namespace adhoc_communication
