// A robot's branches of trees, and the packets of the own group on theirs.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "multicast/source.hpp"

namespace adhoc_communication::multicast {
namespace {

using namespace std::chrono_literals;

const Identity kSelf{"self", {2, 0, 0, 0, 0, 1}, {}, 7};
const MacAddress kA = {2, 0, 0, 0, 0, 0xa}, kB = {2, 0, 0, 0, 0, 0xb}, kC = {2, 0, 0, 0, 0, 0xc};

transport::Image image(std::size_t octets) { return std::make_shared<const Bytes>(octets); }

/// The root of a tree with A behind A, B and C behind B.
struct Root {
  Root() : source(1000, 0), own(branches.of(kSelf.address, kSelf.boot, 0s)) {
    source.fresh_tree(own, {kA, kB, kC}, 0s);
    own.tree.next_epoch();
    own.tree.children = {{kA, {kA}}, {kB, {kB, kC}}};
  }
  std::uint32_t send(SendId id, std::size_t octets, const std::set<MacAddress>& members) {
    return source.start(own, id, Priority::kNormal, image(octets), members, 1s);
  }
  Branches branches{kSelf};
  Source source;
  Branch& own;
};

constexpr auto kStream = static_cast<std::uint8_t>(Priority::kNormal);

TEST(Branches, AnotherRunOfTheRootGetsANewOne) {
  Branches branches(kSelf);
  branches.of(kA, 1, 0s).tree.epoch = 5;
  EXPECT_EQ(branches.of(kA, 1, 1s).tree.epoch, 5u);
  EXPECT_EQ(branches.find(kA, 2), nullptr);
  EXPECT_EQ(branches.of(kA, 2, 1s).tree.epoch, 0u);
  EXPECT_EQ(branches.find(kA, 1), nullptr);
}

TEST(Branches, IdleOnesAreForgottenButNotTheOwn) {
  Branches branches(kSelf);
  branches.of(kSelf.address, 7, 0s);
  branches.of(kA, 1, 0s);
  branches.expire(Branches::kIdleTree - 1ns);
  EXPECT_EQ(branches.all().size(), 2u);
  branches.expire(Branches::kIdleTree);
  EXPECT_EQ(branches.all().size(), 1u);
  EXPECT_NE(branches.own(), nullptr);
}

TEST(Branches, OfTooManyTheOneIdleLongestMakesRoom) {
  Branches branches(kSelf);
  branches.of(kSelf.address, 7, 0s);
  for (std::size_t i = 1; i <= Branches::kMostTrees; ++i) {
    branches.of({4, 0, 0, 0, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)}, 1, i * 1s);
  }
  EXPECT_EQ(branches.all().size(), Branches::kMostTrees);
  EXPECT_NE(branches.own(), nullptr);
  EXPECT_EQ(branches.find({4, 0, 0, 0, 0, 1}, 1), nullptr);
}

TEST(Branches, RoomIsGivenBackWithThePacket) {
  transport::Reassembly reassembly(1000);
  Branches branches(kSelf);
  Branch& branch = branches.of(kA, 1, 0s);
  const transport::Reassembly::Key key{kA, 1, transport::Reassembly::kGroup, 3};
  ASSERT_TRUE(reassembly.admit(key, 500, true, 0s));
  branch.streams[0].transfers[3].room = std::make_unique<Room>(reassembly, key);
  EXPECT_EQ(reassembly.packets(), 1u);
  branches.expire(Branches::kIdleTree);
  EXPECT_EQ(reassembly.packets(), 0u);
}

/// Both grew with every neighbour that came by in an epoch.
TEST(Tree, RemembersNothingOfFormerChildrenAndMembers) {
  Tree tree;
  for (std::uint8_t i = 0; i < 250; ++i) {
    const MacAddress passer_by = {2, 1, 0, 0, 0, i};
    tree.children = {{kA, {kA}}, {passer_by, {kB}}};
    tree.forget_former_children();
    tree.activated_again[passer_by] = 1s;
    tree.refused[passer_by] = {kA};
    tree.forget_refusals_of_others({passer_by, kB});
    EXPECT_LE(tree.largest_table(), 2u);
  }
  EXPECT_EQ(tree.activated_again.size(), 1u);
  EXPECT_EQ(tree.refused.size(), 1u);
}

TEST(Tree, TellsWhichChildrenHearOfAChange) {
  Tree tree;
  tree.children = {{kA, {kA}}, {kB, {kB, kC}}};
  const auto before = tree.children;
  EXPECT_EQ(tree.ways_to({kC}), std::set<MacAddress>{kB});
  EXPECT_TRUE(tree.changed_children(before, false).empty());
  EXPECT_EQ(tree.changed_children(before, true), (std::set<MacAddress>{kA, kB}));
  tree.children = {{kB, {kB}}};
  EXPECT_EQ(tree.changed_children(before, false), (std::set<MacAddress>{kA, kB})) << "one pruned, one with less";
  EXPECT_EQ(tree.keep_attached(before, {kA, kC, {9}}), std::set<MacAddress>{{9}});
}

TEST(Source, APacketEndsWhenEachMemberHasComeToAnEnd) {
  Root root;
  root.send(1, 500, {kA, kB, kC});
  Transfer& transfer = root.own.streams[kStream].transfers.begin()->second;
  root.source.reached(transfer, {kB, kC});
  root.source.reached(transfer, {kB, kC});
  EXPECT_EQ(root.source.take_ends().size(), 2u) << "each once";
  Source::remove_finished(root.own);
  EXPECT_EQ(root.own.streams[kStream].transfers.size(), 1u);
  root.source.drop_member(root.own, kA, "lost");
  const auto ends = root.source.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_FALSE(ends[0].delivered || ends[0].by_copy);
  Source::remove_finished(root.own);
  EXPECT_TRUE(root.own.streams[kStream].transfers.empty());
}

TEST(Source, MembersPassNothingOverThatACopyStillBrings) {
  Root root;
  const std::uint32_t first = root.send(1, 500, {kA});
  const std::uint32_t second = root.send(2, 500, {kA});
  root.source.copy_started(kStream, first);
  root.source.drop_member(root.own, kA, "lost");
  Source::remove_finished(root.own);
  EXPECT_EQ(root.source.oldest_open(root.own, kStream), first);
  root.source.copy_finished(kStream, first);
  EXPECT_EQ(root.source.oldest_open(root.own, kStream), second + 1);
}

TEST(Source, AMemberLeftOverGetsALittlePacketByItselfAndALargeOneByANewTree) {
  Root root;
  root.send(1, 500, {kC});
  root.source.left_over(root.own, {{kC}, "refused", false}, 1s);
  auto ends = root.source.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_TRUE(ends[0].by_copy);
  EXPECT_FALSE(root.source.wants_tree_anew(root.own, 1s));

  root.send(2, 100'000, {kA, kC});
  root.source.left_over(root.own, {{kC}, "refused", false}, 1s);
  EXPECT_TRUE(root.source.take_ends().empty());
  EXPECT_EQ(root.source.wants_tree_anew(root.own, 1s), (std::set<MacAddress>{kA, kB, kC}));
  EXPECT_FALSE(root.source.wants_tree_anew(root.own, 1s)) << "asked once";
  root.source.left_over(root.own, {{kC}, "refused", false}, 1s);
  ends = root.source.take_ends();
  ASSERT_EQ(ends.size(), 1u) << "the second time";
  EXPECT_TRUE(ends[0].by_copy);
}

/// Under steady traffic some are always on their way.
TEST(Source, AStaleTreeIsRenewedThoughPacketsAreOnTheirWay) {
  Root root;
  const auto lose = [&](const MacAddress& member, Time now) {
    root.source.left_over(root.own, {{member}, "refused", false}, now);
  };
  const auto reach = [&](const std::set<MacAddress>& members) {
    for (auto& [number, transfer] : root.own.streams[kStream].transfers) root.source.reached(transfer, members);
    Source::remove_finished(root.own);
  };
  root.send(1, 500, {kA, kB, kC});
  reach({kC});
  root.send(2, 500, {kA, kC});
  lose(kC, 1s);
  EXPECT_TRUE(root.source.wants_fresh_tree(root.own));
  EXPECT_EQ(root.source.fresh_tree(root.own, {kC}, 1s), (std::set<MacAddress>{kA, kB, kC})) << "who awaits something";
  EXPECT_FALSE(root.source.wants_fresh_tree(root.own));

  reach({kC});
  root.send(3, 500, {kC});
  lose(kC, 2s);
  EXPECT_FALSE(root.source.wants_fresh_tree(root.own)) << "those on their way have borne one already";
  reach({kA, kB});
  EXPECT_TRUE(root.source.wants_fresh_tree(root.own));
}

TEST(Source, AMemberThatAFreshTreeDoesNotReachGetsNoOtherForAWhile) {
  Root root;
  const auto lose_a_packet = [&](SendId id, Time now) {
    root.send(id, 500, {kC});
    root.source.left_over(root.own, {{kC}, "refused", false}, now);
    Source::remove_finished(root.own);
    return root.source.wants_fresh_tree(root.own);
  };
  EXPECT_FALSE(lose_a_packet(1, 1s));
  EXPECT_FALSE(lose_a_packet(2, 2s));
  EXPECT_TRUE(lose_a_packet(3, Source::kLeftOut)) << "by now robots have moved";
}

TEST(Source, OnlyAPacketNotBegunIsReplaced) {
  Root root;
  const std::uint32_t number = root.send(1, 500, {kA});
  EXPECT_EQ(root.source.replace(root.own, 1, 2, image(600), {kA}, 2s), number);
  EXPECT_FALSE(root.source.replace(root.own, 1, 3, image(600), {kA}, 2s)) << "it has gone";
  const air::AirClock air(1500);
  const Timings timings = robot_timings();
  const routing::Neighbors neighbors(timings, 250ms);
  root.own.streams[kStream].transfers.at(number).to_children->next(Carriage(air, neighbors), 2s);
  EXPECT_FALSE(root.source.replace(root.own, 2, 3, image(600), {kA}, 2s)) << "some of it was sent";
  EXPECT_EQ(root.source.drop(root.own, 2), std::set<MacAddress>{kA});
}

TEST(Source, APacketThatHasEndedForOneMemberIsNotReplacedForTheRest) {
  Root root;
  root.send(1, 500, {kA, kB});
  root.source.drop_member(root.own, kA, "lost");
  EXPECT_FALSE(root.source.replace(root.own, 1, 2, image(600), {kB}, 2s));
  EXPECT_EQ(root.source.take_ends().size(), 1u);
}

TEST(Source, APacketThatAMemberHasGotByItselfIsNotReplacedForTheRest) {
  Root root;
  const std::uint32_t number = root.send(1, 500, {kB});
  root.source.copy_started(kStream, number);
  root.source.copy_finished(kStream, number);
  EXPECT_FALSE(root.source.replace(root.own, 1, 2, image(600), {kA, kB}, 2s)) << "kA would never get the new one";
  EXPECT_TRUE(root.source.replace(root.own, 1, 2, image(600), {kB}, 2s));
}

/// It got a copy of every packet, as its words came too late to be counted and those of the near one kept the timeout
/// short.
TEST(Source, LearnsToWaitForAMemberWhoseReceiptsTakeLongerThanThoseOfOthers) {
  Root root;
  const auto receipt = [](const MacAddress& member, const wire::GroupData& packet) {
    wire::GroupReceipt receipt;
    receipt.member = member;
    receipt.stream = packet.stream;
    receipt.next = packet.packet + 1;
    return receipt;
  };
  std::vector<bool> copied;
  for (Time now = 10s; now < 100s; now += 3s) {
    const wire::GroupData packet = root.source.start_flooded(root.own, 1, Priority::kNormal, image(500), {kA, kB}, now);
    root.source.receipt(root.own, receipt(kA, packet), now + 50ms);
    root.source.serve_late(root.own, now + 900ms);
    root.source.receipt(root.own, receipt(kB, packet), now + 900ms);
    const std::vector<MemberEnd> ends = root.source.take_ends();
    copied.push_back(std::any_of(ends.begin(), ends.end(), [](const MemberEnd& end) { return end.by_copy; }));
  }
  EXPECT_TRUE(copied.front()) << "otherwise this tests nothing";
  EXPECT_EQ(std::count(copied.end() - 20, copied.end(), true), 0);
}

wire::GroupReceipt receipt_of(const MacAddress& member, std::uint32_t next, std::uint32_t beyond = 0) {
  wire::GroupReceipt receipt;
  receipt.member = member;
  receipt.stream = kStream;
  receipt.next = next;
  receipt.beyond = beyond;
  return receipt;
}

/// Floods packets 0 and on, a second apart, of which the member says nothing so far.
void flood(Root& root, int packets) {
  for (int packet = 0; packet < packets; ++packet)
    root.source.start_flooded(root.own, 1 + packet, Priority::kNormal, image(500), {kA}, 10s + packet * 1s);
}

/// Until then only the timeout told, which is long where receipts of some take long.
TEST(Source, AMemberThatHasALaterFloodedPacketIsSentTheOneBefore) {
  Root root;
  root.source.start_flooded(root.own, 1, Priority::kNormal, image(500), {kA}, 10s);
  root.source.start_flooded(root.own, 2, Priority::kNormal, image(500), {kA}, 10050ms);
  root.source.receipt(root.own, receipt_of(kA, 0, 1), 10100ms);
  root.source.serve_late(root.own, 10100ms + Source::kMissed - 1ms);
  EXPECT_TRUE(root.source.take_ends().empty()) << "it may have been overtaken";
  EXPECT_EQ(root.source.next_late(), 10100ms + Source::kMissed);
  root.source.serve_late(root.own, 10100ms + Source::kMissed);
  const std::vector<MemberEnd> ends = root.source.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_TRUE(ends[0].id == 1 && ends[0].by_copy && !ends[0].delivered);
}

/// Each was sent a copy, too, once it had waited for 2 s.
TEST(Source, PacketsThatWaitAtAMemberForOneThatGoesThereByItselfGetNoCopies) {
  Root root;
  flood(root, 3);
  root.source.receipt(root.own, receipt_of(kA, 0, 3), 12100ms);
  for (Time now = 12100ms; now < 19s; now += 100ms) root.source.serve_late(root.own, now);
  std::vector<MemberEnd> ends = root.source.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_TRUE(ends[0].id == 1 && ends[0].by_copy);
  root.source.copy_arrived(root.own, kA, {kStream, 0}, 19s);
  ends = root.source.take_ends();
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_TRUE(ends[0].delivered && ends[1].delivered && !ends[0].by_copy && !ends[1].by_copy);
}

/// Each that waited in vain would have the next one wait as long again, and all later packets take the tree.
TEST(Source, ACopyThatDoesNotArriveHoldsNoPacketBackForLong) {
  Root root;
  flood(root, 6);
  root.source.receipt(root.own, receipt_of(kA, 0, 0x1f), 15100ms);
  std::size_t ended = 0;
  for (Time now = 15100ms; now < 15s + Source::kCopyTakes + FloodTimes::kLongest; now += 100ms) {
    root.source.serve_late(root.own, now);
    for (const MemberEnd& end : root.source.take_ends()) ended += end.by_copy;
  }
  EXPECT_EQ(ended, 6u);
}

}  // namespace
}  // namespace adhoc_communication::multicast
