// The trees of groups: part B of docs/aodv.md, as far as it applies to trees that have their source as root.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "finish.hpp"
#include "host.hpp"
#include "insider.hpp"
#include "multicast/groups.hpp"
#include "texts.hpp"
#include "transport/packet_image.hpp"
#include "tree_invariants.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using wire::FrameType;

TEST(Trees, B1_6_ActivationIsInNetworkByteOrder) {
  const wire::GroupActivation activation{{2, 0, 0, 0, 0, 1}, 0x1112131415161718, 0x01020304, {{2, 0, 0, 0, 0, 2}}};
  const Bytes expected = {2,    0, 0, 0, 0, 1, 0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17,
                          0x18, 1, 2, 3, 4, 1, 2,    0,    0,    0,    0,    2};
  EXPECT_EQ(wire::to_bytes(activation), expected);
  EXPECT_EQ(wire::to_bytes(wire::read_group_activation(wire::Reader(expected)).value()), expected);
}

/// The first packet of the root's group, in one frame.
wire::GroupData packet_of(const Host& root) {
  wire::GroupData data;
  data.root = root.address;
  data.root_boot = root.boot();
  data.round = data.packet = data.base = 1;
  data.total = data.segment_size = 100;
  data.octets = noise(100);
  return data;
}

/// A node between a, which is the root or nearer to it, and b.
struct Branch : Stage {
  Branch() : a(neighbor(1)), b(neighbor(2)) {
    run_for(50ms);
    team.engine(0).join_group("mc_" + a.name, now());
  }
  void activate(Host& from, std::uint32_t epoch, const std::vector<MacAddress>& members) {
    say(from, wire::GroupActivation{a.address, a.boot(), epoch, members}, self().address);
    run_for(5ms);
  }
  std::optional<TreeState> tree() {
    for (const TreeState& tree : node().trees()) {
      if (tree.root == a.address) return tree;
    }
    return std::nullopt;
  }
  Host& a;
  Host& b;
};

TEST(Trees, B2_1_ATreeTellsRootEpochAndNeighbors) {
  Branch branch;
  branch.give_route(branch.b, kFar);
  branch.activate(branch.a, 7, {branch.self().address, kFar.address});
  const auto tree = branch.tree();
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->epoch, 7u);
  EXPECT_EQ(tree->boot, branch.a.boot());
  EXPECT_EQ(tree->upstream, branch.a.address);
  EXPECT_EQ(tree->downstream, std::vector<MacAddress>{branch.b.address});
  const GroupState state = branch.node().group_state("mc_" + branch.a.name);
  EXPECT_TRUE(state.known && state.activated && !state.root);
  EXPECT_EQ(state.downlinks, std::vector<std::string>{branch.b.name});
}

/// Only beacons tell names, and a tree may reach a robot of which none was heard yet.
TEST(Trees, NeighborsWithoutANameAreShownByTheirAddress) {
  Branch branch;
  Host& above = branch.neighbor(3, false);
  Host& below = branch.neighbor(4, false);
  branch.acknowledge(above);
  branch.acknowledge(below);
  branch.give_route(below, kFar);
  branch.activate(above, 7, {branch.self().address, kFar.address});
  const GroupState state = branch.node().group_state("mc_" + branch.a.name);
  EXPECT_EQ(state.downlinks, std::vector<std::string>{address_text(below.address)});
  EXPECT_EQ(state.uplink, address_text(above.address));
  EXPECT_EQ(state.route_uplink.rfind("Next hop:" + address_text(above.address) + " ", 0), 0u) << state.route_uplink;
}

TEST(Trees, B2_4_EpochsAreComparedAsSequenceNumbers) {
  Branch branch;
  branch.activate(branch.a, 0xfffffff0, {branch.self().address});
  branch.activate(branch.b, 0xffffffef, {branch.self().address});
  EXPECT_EQ(branch.tree()->epoch, 0xfffffff0u);
  EXPECT_EQ(branch.tree()->upstream, branch.a.address);
  branch.activate(branch.b, 0x10, {branch.self().address});
  EXPECT_EQ(branch.tree()->epoch, 0x10u);
  EXPECT_EQ(branch.tree()->upstream, branch.b.address);
}

TEST(Trees, B4_3_AnActivationIsPassedOnTowardsTheMembers) {
  Branch branch;
  branch.give_route(branch.b, kFar);
  branch.activate(branch.a, 1, {branch.self().address, kFar.address, branch.b.address});
  const auto passed = branch.sent<wire::GroupActivation>();
  ASSERT_EQ(passed.size(), 1u);
  EXPECT_EQ(passed[0].to, branch.b.address);
  EXPECT_EQ(passed[0].message.epoch, 1u);
  EXPECT_EQ(std::set<MacAddress>(passed[0].message.members.begin(), passed[0].message.members.end()),
            (std::set<MacAddress>{kFar.address, branch.b.address}));
  branch.activate(branch.a, 1, {branch.self().address, kFar.address, branch.b.address});
  EXPECT_EQ(branch.sent<wire::GroupActivation>().size(), 1u) << "nothing is new";
}

TEST(Trees, B2_2_B4_4_OneUpstreamNeighborInAnEpochAndNoOther) {
  Branch branch;
  branch.activate(branch.a, 3, {branch.self().address});
  branch.activate(branch.b, 3, {branch.self().address});
  EXPECT_EQ(branch.tree()->upstream, branch.a.address);
  const auto refusals = branch.sent<wire::GroupRefusal>();
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(refusals[0].to, branch.b.address);
  EXPECT_EQ(refusals[0].message.members, std::vector<MacAddress>{branch.self().address});
}

TEST(Trees, B4_4_ARobotThatHadNobodyBehindItMayGetAnotherPlace) {
  Branch branch;
  Host& c = branch.neighbor(3);
  branch.run_for(50ms);
  branch.activate(branch.a, 3, {branch.self().address});
  ASSERT_EQ(branch.tree()->upstream, branch.a.address);
  branch.activate(branch.a, 3, {});  // pruned
  EXPECT_FALSE(branch.tree()->upstream);
  branch.activate(branch.b, 3, {c.address});
  EXPECT_EQ(branch.tree()->upstream, branch.b.address);
  EXPECT_EQ(branch.count(FrameType::kGroupRefusal), 0u);
}

/// Who was behind it may still count on it, and be above the other place.
TEST(Trees, B4_4_B11_1_ARobotThatHadAnybodyBehindItComesBackToItsPlaceOnly) {
  Branch branch;
  Host& c = branch.neighbor(3);
  branch.run_for(50ms);
  branch.activate(branch.a, 3, {c.address});
  branch.activate(branch.a, 3, {});
  branch.activate(branch.b, 3, {c.address});
  EXPECT_FALSE(branch.tree()->upstream);
  const auto refusals = branch.sent<wire::GroupRefusal>();
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(refusals[0].to, branch.b.address);
  branch.activate(branch.a, 3, {c.address});
  EXPECT_EQ(branch.tree()->upstream, branch.a.address);
  branch.activate(branch.a, 3, {});
  branch.activate(branch.b, 4, {c.address});
  EXPECT_EQ(branch.tree()->upstream, branch.b.address) << "in another epoch everybody may be anywhere";
}

/// The new run knows nothing of the place of the former one, and may be somewhere behind this robot.
TEST(Trees, B10_1_B11_1_ARobotWhoseUpstreamNeighborRestartsIsNotBelowTheNewRun) {
  for (const bool missed : {false, true}) {
    Branch branch;
    Host& c = branch.neighbor(3);
    branch.run_for(50ms);
    branch.activate(branch.b, 3, {branch.self().address, c.address});
    ASSERT_EQ(branch.tree()->upstream, branch.b.address);
    branch.b.beacons = !missed;
    branch.run_for(missed ? 8s : 1s);  // silent for so long, it was forgotten
    ASSERT_EQ(branch.tree()->upstream, branch.b.address);
    branch.restart(branch.b);
    EXPECT_FALSE(branch.tree()->upstream);
    branch.activate(branch.b, 3, {c.address});
    EXPECT_FALSE(branch.tree()->upstream);
    branch.activate(branch.b, 4, {c.address});
    EXPECT_EQ(branch.tree()->upstream, branch.b.address);
  }
}

TEST(Trees, B11_1_AnUpstreamNeighborThatWasSilentForLongIsStillThat) {
  Branch branch;
  Host& c = branch.neighbor(3);
  branch.run_for(50ms);
  branch.activate(branch.b, 3, {branch.self().address, c.address});
  branch.b.beacons = false;
  branch.run_for(8s);
  branch.b.beacons = true;
  branch.run_for(1s);
  branch.activate(branch.b, 3, {branch.self().address, c.address});
  EXPECT_EQ(branch.tree()->upstream, branch.b.address);
  EXPECT_EQ(branch.count(FrameType::kGroupRefusal), 0u);
}

TEST(Trees, B4_5_WhoHasNotJoinedRefusesItself) {
  Branch branch;
  branch.say(branch.b, wire::GroupActivation{branch.b.address, branch.b.boot(), 1, {branch.self().address}},
             branch.self().address);
  branch.run_for(5ms);
  const auto refusals = branch.sent<wire::GroupRefusal>();
  ASSERT_EQ(refusals.size(), 1u) << "a former run may have been a member";
  EXPECT_EQ(refusals[0].to, branch.b.address);
  EXPECT_EQ(refusals[0].message.members, std::vector<MacAddress>{branch.self().address});
}

TEST(Trees, B4_5_MembersThatCannotBeReachedAreRefused) {
  Branch branch;
  branch.give_route(branch.a, kFar);
  const MacAddress nowhere = make_host(101).address;
  branch.activate(branch.a, 1, {kFar.address, nowhere});
  ASSERT_EQ(branch.sent<wire::GroupRefusal>().size(), 1u);
  EXPECT_EQ(branch.sent<wire::GroupRefusal>()[0].to, branch.a.address);
  EXPECT_EQ(branch.sent<wire::GroupRefusal>()[0].message.members, std::vector<MacAddress>{kFar.address});
  branch.run_for(3s);  // the other one was searched for in vain
  ASSERT_EQ(branch.sent<wire::GroupRefusal>().size(), 2u);
  EXPECT_EQ(branch.sent<wire::GroupRefusal>()[1].message.members, std::vector<MacAddress>{nowhere});
}

/// Routes to two members may meet at a robot that can take only one neighbour upstream.
TEST(Trees, B4_5_AMemberThatOneChildRefusesIsTriedThroughAnother) {
  Branch branch;
  Host& c = branch.neighbor(3);
  branch.run_for(50ms);
  branch.give_route(branch.b, kFar);
  branch.activate(branch.a, 1, {kFar.address, branch.b.address, c.address});
  branch.forget();
  const wire::GroupRefusal refusal{branch.a.address, branch.a.boot(), 1, {kFar.address}};
  branch.say(branch.b, refusal, branch.self().address);
  branch.run_for(5ms);
  ASSERT_EQ(branch.sent<wire::GroupActivation>().size(), 1u);
  EXPECT_EQ(branch.sent<wire::GroupActivation>()[0].to, c.address);
  EXPECT_EQ(branch.sent<wire::GroupActivation>()[0].message.members.size(), 2u);
  EXPECT_EQ(branch.count(FrameType::kGroupRefusal), 0u);
  branch.say(c, refusal, branch.self().address);
  branch.run_for(5ms);
  ASSERT_EQ(branch.sent<wire::GroupRefusal>().size(), 1u) << "nobody is left to try";
  EXPECT_EQ(branch.sent<wire::GroupRefusal>()[0].to, branch.a.address);
}

TEST(Trees, B5_3_ARobotWithoutMembersBehindItPrunesItsBranch) {
  Branch branch;
  branch.give_route(branch.b, kFar);
  branch.activate(branch.a, 1, {kFar.address});
  branch.forget();
  branch.activate(branch.a, 1, {});
  const auto passed = branch.sent<wire::GroupActivation>();
  ASSERT_EQ(passed.size(), 1u);
  EXPECT_EQ(passed[0].to, branch.b.address);
  EXPECT_TRUE(passed[0].message.members.empty());
  EXPECT_TRUE(branch.tree()->downstream.empty());
}

TEST(Trees, B5_6_IdleTreesAreForgotten) {
  Branch branch;
  branch.activate(branch.a, 1, {branch.self().address});
  branch.run_for(59s);
  EXPECT_TRUE(branch.tree());
  branch.run_for(3s);
  EXPECT_FALSE(branch.tree());
}

/// As long as anybody counts on its place, a robot has to know what place that was.
TEST(Trees, B5_6_B11_1_APlaceIsRememberedLongerThanThoseBehindItKeepTheirs) {
  Branch branch;
  Host& c = branch.neighbor(3);
  branch.run_for(50ms);
  branch.activate(branch.b, 3, {branch.self().address, c.address});
  const wire::GroupData data = packet_of(branch.a);
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(branch.tree()->upstream, branch.b.address);
    branch.run_for(9s);
    branch.say(branch.a, data);  // overheard
  }
  EXPECT_FALSE(branch.tree()->upstream);
  EXPECT_TRUE(branch.tree()->downstream.empty());
  branch.run_for(60s);
  branch.activate(branch.a, 3, {c.address});
  EXPECT_FALSE(branch.tree()->upstream);
  branch.activate(branch.b, 3, {c.address});
  EXPECT_EQ(branch.tree()->upstream, branch.b.address);
  branch.run_for(179s);
  EXPECT_TRUE(branch.tree());
  branch.run_for(3s);
  EXPECT_FALSE(branch.tree());
}

TEST(Trees, B7_1_B7_6_ALostLinkIsReportedUpstream) {
  Branch branch;
  branch.give_route(branch.b, kFar);
  branch.activate(branch.a, 1, {branch.self().address, kFar.address});
  branch.b.beacons = branch.b.acknowledges = false;
  branch.run_for(3s);
  const auto refusals = branch.sent<wire::GroupRefusal>();
  ASSERT_EQ(refusals.size(), 1u);
  EXPECT_EQ(refusals[0].to, branch.a.address);
  EXPECT_EQ(refusals[0].message.members, std::vector<MacAddress>{kFar.address});
}

TEST(Trees, B7_3_AChildThatKnowsAnotherTreeIsActivatedAgain) {
  Branch branch;
  branch.give_route(branch.b, kFar);
  branch.activate(branch.a, 5, {kFar.address});
  const wire::GroupData data = packet_of(branch.a);
  branch.say(branch.a, data);
  branch.run_for(100ms);
  branch.forget();
  wire::GroupReport report;
  report.root = data.root;
  report.root_boot = data.root_boot;
  report.packet = 1;
  report.epoch = 4;
  report.round = 1;
  report.missing = {1};
  branch.say(branch.b, report, branch.self().address);
  branch.run_for(5ms);
  const auto again = branch.sent<wire::GroupActivation>();
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].to, branch.b.address);
  EXPECT_EQ(again[0].message.epoch, 5u);
  EXPECT_EQ(again[0].message.members, std::vector<MacAddress>{kFar.address});
}

TEST(Trees, B9_2_ReplayedPacketsAreDeliveredOnce) {
  Branch branch;
  const std::string group = "mc_" + branch.a.name;
  branch.node().join_group(group, branch.now());
  branch.activate(branch.a, 1, {branch.self().address});
  const transport::Image image = transport::encode({transport::PacketKind::kUser, 'A', group, "topic", noise(200)});
  wire::GroupData data;
  data.root = branch.a.address;
  data.root_boot = branch.a.boot();
  data.round = data.base = 1;
  data.total = static_cast<std::uint32_t>(image->size());
  data.segment_size = 1000;
  data.octets = *image;
  for (const std::uint32_t packet : {1u, 1u, 2u, 1u, 2u}) {
    data.packet = packet;
    branch.say(branch.a, data);
    branch.run_for(10ms);
  }
  EXPECT_EQ(branch.team.received(0).size(), 2u);
}

/// What each robot knows of the tree of robot 0.
std::map<MacAddress, TreeState> tree_of_robot_0(Team& team) {
  std::map<MacAddress, TreeState> trees;
  for (std::size_t robot = 0; robot < team.size(); ++robot) {
    if (!team.alive(robot)) continue;
    for (const TreeState& tree : team.engine(robot).trees()) {
      if (tree.root == Team::address(0)) trees[Team::address(robot)] = tree;
    }
  }
  return trees;
}

/// Each link is known at both ends, and every robot has a way up to the root.
void expect_whole(Team& team) {
  const auto trees = tree_of_robot_0(team);
  EXPECT_EQ(trees.size(), team.size());
  for (const auto& [robot, tree] : trees) {
    EXPECT_EQ(tree.upstream.has_value(), robot != Team::address(0));
    if (tree.upstream) {
      const auto& above = trees.at(*tree.upstream).downstream;
      EXPECT_TRUE(std::count(above.begin(), above.end(), robot) == 1) << "robot_" << int{robot[5]};
    }
    for (const MacAddress& below : tree.downstream) EXPECT_EQ(trees.at(below).upstream, robot);
    MacAddress at = robot;
    for (std::size_t hops = 0; hops < team.size() && trees.at(at).upstream; ++hops) at = *trees.at(at).upstream;
    EXPECT_EQ(at, Team::address(0));
  }
}

TEST(Trees, B4_1_B4_2_EachLinkIsActivatedOnceAndNotAgainForTheNextPacket) {
  Team team;
  team.add_line(4);
  team.run_for(5s);
  std::map<std::pair<std::size_t, MacAddress>, int> activations;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (frame.bytes[1] == static_cast<std::uint8_t>(FrameType::kGroupActivation))
      ++activations[{robot, frame.destination}];
  };
  for (int packet = 0; packet < 3; ++packet) ASSERT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(5000))));
  const std::map<std::pair<std::size_t, MacAddress>, int> expected = {
      {{0, Team::address(1)}, 1}, {{1, Team::address(2)}, 1}, {{2, Team::address(3)}, 1}};
  EXPECT_EQ(activations, expected);
}

TEST(Trees, B4_4_B9_2_InADiamondAMemberIsServedByOneSide) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    Team team({}, seed);
    team.add({}, 0, 0);
    team.add({}, 7, 4);
    team.add({}, 7, -4);
    team.add({}, 14, 0);
    team.run_for(5s);
    for (int packet = 0; packet < 5; ++packet) ASSERT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(3000))));
    for (std::size_t robot = 1; robot < 4; ++robot) EXPECT_EQ(team.received(robot).size(), 5u);
    const auto trees = tree_of_robot_0(team);
    EXPECT_EQ(trees.at(Team::address(1)).downstream.size() + trees.at(Team::address(2)).downstream.size(), 1u);
    expect_whole(team);
  }
}

/// Epochs that a send costs which begins when the tree has just lost its only link, to robot 3, of two possible ones.
std::uint32_t epochs_for(std::size_t octets) {
  Team team;
  for (const auto& [x, y] : {std::pair(0.0, 0.0), {7.0, 4.0}, {7.0, -4.0}, {14.0, 0.0}}) {
    team.add(without_groups(), x, y);
  }
  team.run_for(2s);
  team.engine(3).join_group("mc_robot_0", team.now());
  team.run_for(2s);
  EXPECT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(20'000))));
  const auto trees = tree_of_robot_0(team);
  const std::uint32_t before = trees.at(Team::address(0)).epoch;
  team.medium().set_link_loss(trees.count(Team::address(1)) != 0 ? 1 : 2, 3, 1.0);
  const SendId id = team.send(0, "mc_robot_0", noise(octets));
  EXPECT_TRUE(finish(team, 0, id));
  EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
  EXPECT_EQ(team.received(3).size(), 2u);
  return tree_of_robot_0(team)[Team::address(0)].epoch - before;
}

TEST(Trees, B7_1_OnlyALargePacketIsWorthANewTreeAtOnce) {
  EXPECT_EQ(epochs_for(1000), 0u);
  EXPECT_GE(epochs_for(100'000), 1u);
}

/// Two relays between the root and the last two of the team, one behind the other: the first of these is bound. One of
/// the relays is no member, so that they are too few for a flood.
struct TwoWays {
  explicit TwoWays(std::uint64_t seed) : team(lossy(), seed) {
    for (const auto& [x, y] : {std::pair(0.0, 0.0), {7.0, 4.0}, {7.0, -4.0}, {14.0, 0.0}, {22.0, 0.0}}) {
      team.add(without_groups(), x, y);
    }
    team.run_for(1s);
    for (const std::size_t member : {1u, 3u, 4u}) team.engine(member).join_group("mc_robot_0", team.now());
    team.run_for(4s);
    team.on_transmission = [this](std::size_t robot, const Frame& frame) {
      const bool data = frame.bytes[1] == static_cast<std::uint8_t>(FrameType::kData);
      copies += robot == 0 && data && frame.bytes.size() > 1000;
    };
  }
  static MediumOptions lossy() {
    MediumOptions medium;
    medium.loss = 0.2;
    medium.bit_rate = 2e6;
    return medium;
  }
  void send_for(Time duration) {
    for (const Time end = team.now() + duration; team.now() < end; team.run_for(20ms)) {
      sent.push_back(team.send(0, "mc_robot_0", noise(1000, sent.size())));
    }
  }
  /// Between robot 3 and whoever is above it.
  void break_link() {
    for (const std::size_t relay : {1u, 2u}) {
      if (tree_of_robot_0(team).at(Team::address(3)).upstream == Team::address(relay)) {
        team.medium().set_link_loss(relay, 3, 1.0);
      }
    }
  }
  Team team;
  std::vector<SendId> sent;
  int copies = 0;  ///< frames of packets for one member
};

/// Of packets that follow each other closely one is always open, and one on its way to whoever is served by itself.
/// While that was so no tree was built anew, and the tree left out whoever had lost its place.
TEST(Trees, B7_1_WhoHasLostItsPlaceGetsAnotherWhilePacketsFollowEachOther) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    TwoWays line(seed);
    line.send_for(1s);
    line.break_link();
    line.send_for(3s);
    EXPECT_GT(line.copies, 0);
    line.copies = 0;
    line.send_for(2s);
    EXPECT_EQ(line.copies, 0) << "seed " << seed;
    for (const SendId id : line.sent) {
      ASSERT_TRUE(finish(line.team, 0, id) && line.team.finished(0, id)->delivered) << "seed " << seed;
    }
    for (const std::size_t robot : {3u, 4u}) {
      ASSERT_EQ(line.team.received(robot).size(), line.sent.size()) << "seed " << seed;
      for (std::size_t i = 0; i < line.sent.size(); ++i) {
        ASSERT_EQ(line.team.received(robot)[i].packet.payload, noise(1000, i)) << "in order";
      }
    }
  }
}

/// A line of 4 of which only the given robots are in the group of robot 0.
struct Members {
  explicit Members(const std::vector<std::size_t>& members) {
    team.add_line(4, without_groups());
    team.run_for(2s);
    for (const std::size_t member : members) team.engine(member).join_group("mc_robot_0", team.now());
    team.run_for(2s);
    send();
  }
  void leave(std::size_t member) {
    team.engine(member).leave_group("mc_robot_0", team.now());
    team.run_for(1s);
  }
  void send() { EXPECT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(3000)))); }
  std::size_t downstream(std::size_t robot) { return tree_of_robot_0(team)[Team::address(robot)].downstream.size(); }
  Team team;
};

TEST(Trees, B5_1_B5_3_OneLeaveRemovesTheWholeBranch) {
  Members line({3});
  for (std::size_t robot = 0; robot < 3; ++robot) EXPECT_EQ(line.downstream(robot), 1u);
  line.leave(3);
  for (std::size_t robot = 0; robot < 3; ++robot) EXPECT_EQ(line.downstream(robot), 0u);
  line.send();
  EXPECT_EQ(line.team.received(3).size(), 1u);
}

TEST(Trees, B5_2_AMemberThatLeavesStillServesThoseBehindIt) {
  Members line({2, 3});
  line.leave(2);
  line.send();
  EXPECT_EQ(line.team.received(2).size(), 1u);
  EXPECT_EQ(line.team.received(3).size(), 2u);
}

/// Members that the tree did not reach get copies first, and are taken in with a later packet.
void expect_whole_after_three_packets(Team& team) {
  std::uint32_t epoch = 0;
  for (int packet = 0; packet < 3; ++packet) {
    epoch = tree_of_robot_0(team)[Team::address(0)].epoch;
    const SendId id = team.send(0, "mc_robot_0", noise(5000));
    ASSERT_TRUE(finish(team, 0, id));
    EXPECT_TRUE(team.finished(0, id)->delivered) << team.finished(0, id)->reason;
    team.run_for(1s);
  }
  expect_whole(team);
  EXPECT_EQ(tree_of_robot_0(team)[Team::address(0)].epoch, epoch) << "nothing happens, and the tree is built anew";
}

TEST(Trees, B7_3_B11_2_B11_3_AfterDetoursAndPartitionsTheTreeIsWhole) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    MediumOptions medium;
    medium.loss = 0.05;
    Team team(medium, seed);
    for (int i = 0; i < 9; ++i) team.add({}, (i % 3) * 8.0, (i / 3) * 8.0);
    team.run_for(5s);
    expect_whole_after_three_packets(team);
    team.medium().set_link_loss(0, 1, 1.0);
    ASSERT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(5000))));
    team.medium().set_link_loss(0, 3, 1.0);
    ASSERT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(5000))));
    for (const std::size_t near : {1u, 3u}) team.medium().set_link_loss(0, near, std::nullopt);
    team.run_for(12s);
    expect_whole_after_three_packets(team);
  }
}

/// A line of 5, the last two of them members of the group of the first, with the promises about trees checked at every
/// step.
struct WatchedLine {
  WatchedLine() : invariants(5) {
    team.add_line(5, without_groups());
    for (std::size_t robot = 0; robot < 5; ++robot) invariants.booted(robot, team.boot_id(robot));
    team.after_step = [this](std::size_t robot) { invariants.changed(robot, team.engine(robot).trees()); };
    team.run_for(2s);
    for (const std::size_t member : {3u, 4u}) team.engine(member).join_group("mc_robot_0", team.now());
    team.run_for(2s);
    EXPECT_TRUE(finish(team, 0, team.send(0, "mc_robot_0", noise(3000))));
  }
  std::optional<MacAddress> above(std::size_t robot) { return tree_of_robot_0(team)[Team::address(robot)].upstream; }

  Team team;
  TreeInvariants invariants;
};

/// robot_1 no longer hears robot_2 and gives it up, which robot_2 has no way to know. Then robot_3, still behind it, is
/// to look for the way to robot_4 anew, and that leads over robot_1.
TEST(Trees, B11_1_WhoHasGivenUpAChildGetsNoPlaceBehindIt) {
  WatchedLine line;
  Team& team = line.team;
  team.medium().set_one_way_loss(2, 1, 1.0);
  team.send(0, "mc_robot_0", noise(3000));
  ASSERT_TRUE(team.run_until_done([&] { return !line.above(1); }, 5s));
  team.medium().set_position(4, 8, 8);
  team.medium().set_link_loss(1, 3, 0.0);
  team.run_for(5s);
  ASSERT_EQ(line.above(2), Team::address(1));
  ASSERT_EQ(line.above(3), Team::address(2));

  std::size_t asked = 0, refused = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const auto type = static_cast<FrameType>(frame.bytes[1]);
    asked += robot == 3 && type == FrameType::kGroupActivation && frame.destination == Team::address(1);
    refused += robot == 1 && type == FrameType::kGroupRefusal && frame.destination == Team::address(3);
  };
  const TreeState tree = tree_of_robot_0(team)[Team::address(3)];
  Insider again(team, Insider(team, kFar, {}).robot(2), {});
  again.say(3, wire::GroupActivation{tree.root, tree.boot, tree.epoch, {Team::address(3), Team::address(4)}});
  EXPECT_NO_THROW(team.run_for(2s));
  EXPECT_GT(asked, 0u);
  EXPECT_GT(refused, 0u);
}

/// A relay that was sent copies told those behind it to pass over packets that the root still had for them.
TEST(Relay, CopiesForItSayNothingOfWhatThoseBehindItAwait) {
  Stage stage;
  Host& root = stage.neighbor(1);
  Host& child = stage.neighbor(2);
  stage.run_for(100ms);
  stage.node().join_group("mc_host_1", stage.now());
  const auto image = [](const std::string& words) {
    return transport::encode({transport::PacketKind::kUser, 'A', "mc_host_1", "topic", text(words)});
  };
  for (std::uint32_t number = 3; number <= 4; ++number) {
    const transport::Image copy = transport::image_of(
        {transport::PacketKind::kGroupCopy, 0, "mc_host_1", {}, multicast::encode_copy({2, number, image("copy")})});
    wire::Data data = data_for(stage.self(), root, number - 2);
    data.octets = *copy;
    data.total = static_cast<std::uint32_t>(copy->size());
    stage.say(root, data, stage.self().address);
    stage.run_for(10ms);
  }
  EXPECT_EQ(stage.team.received(0).size(), 2u);
  stage.say(root, wire::GroupActivation{root.address, root.boot(), 1, {stage.self().address, child.address}},
            stage.self().address);
  wire::GroupData data;
  data.root = root.address;
  data.root_boot = root.boot();
  data.stream = 2;
  data.packet = 5;
  data.base = 2;
  data.octets = *image("tree");
  data.total = static_cast<std::uint32_t>(data.octets.size());
  data.segment_size = 1000;
  stage.forget();
  stage.say(root, data, stage.self().address);
  stage.run_for(10ms);
  EXPECT_EQ(stage.team.received(0).size(), 3u);
  const auto passed_on = stage.sent<wire::GroupData>();
  ASSERT_FALSE(passed_on.empty());
  EXPECT_EQ(passed_on[0].message.base, 2u);
}

}  // namespace
}  // namespace adhoc_communication
