// Packets of a group that go to members by themselves: a few at a time.
#include <gtest/gtest.h>

#include <set>

#include "multicast/copy_queue.hpp"
#include "payloads.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using multicast::CopyQueue;
using multicast::HeldPacket;
using multicast::WaitingCopy;

WaitingCopy copy_for(const std::string& member, Priority priority, SendId parent = 1) {
  HeldPacket packet;
  packet.stream = static_cast<std::uint8_t>(priority);
  return {member, packet, transport::Purpose::kFanOut, parent};
}

constexpr auto kNormal = static_cast<std::uint8_t>(Priority::kNormal);

/// As many members as are served at a time, and two more.
void fill(CopyQueue& queue, Priority priority) {
  for (std::size_t i = 0; i < CopyQueue::kMostServed + 2; ++i) queue.add(copy_for(std::to_string(i), priority));
}

TEST(CopyQueue, AFewMembersAreServedAndTheOthersFollowInOrder) {
  CopyQueue queue;
  fill(queue, Priority::kNormal);
  for (std::size_t i = 0; i < CopyQueue::kMostServed; ++i) EXPECT_EQ(queue.next()->member, std::to_string(i));
  EXPECT_FALSE(queue.next());
  queue.finished("0", kNormal);
  EXPECT_EQ(queue.next()->member, std::to_string(CopyQueue::kMostServed));
  EXPECT_FALSE(queue.next());
}

TEST(CopyQueue, WhoIsServedGetsAllThatThereIs) {
  CopyQueue queue;
  fill(queue, Priority::kNormal);
  const std::string last = std::to_string(CopyQueue::kMostServed);
  queue.add(copy_for("0", Priority::kNormal));
  queue.add(copy_for(last, Priority::kNormal));
  for (std::size_t i = 0; i < CopyQueue::kMostServed; ++i) ASSERT_TRUE(queue.next());
  EXPECT_EQ(queue.next()->member, "0") << "its second one";
  EXPECT_FALSE(queue.next());
  queue.finished("0", kNormal);
  EXPECT_FALSE(queue.next()) << "one more is on its way to it";
  queue.finished("0", kNormal);
  EXPECT_EQ(queue.next()->member, last);
  EXPECT_EQ(queue.next()->member, last);
  EXPECT_FALSE(queue.next());
}

TEST(CopyQueue, UrgentOnesDoNotWaitForOthers) {
  CopyQueue queue;
  fill(queue, Priority::kBulk);
  while (queue.next()) {
  }
  queue.add(copy_for("urgent", Priority::kControl));
  const auto next = queue.next();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->member, "urgent");
}

TEST(CopyQueue, ThoseOfASendThatHasEndedAreTakenOut) {
  CopyQueue queue;
  fill(queue, Priority::kNormal);
  while (queue.next()) {
  }
  WaitingCopy late = copy_for("late", Priority::kNormal);
  late.purpose = transport::Purpose::kCatchUp;
  queue.add(late);
  queue.add(copy_for("other", Priority::kNormal, 2));
  const auto dropped = queue.drop(1);
  ASSERT_EQ(dropped.size(), 2u);
  EXPECT_EQ(dropped[0].member, std::to_string(CopyQueue::kMostServed));
  queue.finished("0", kNormal);
  queue.finished("1", kNormal);
  EXPECT_EQ(queue.next()->member, "late") << "a newcomer's, which belongs to no send";
  EXPECT_EQ(queue.next()->member, "other");
}

/// What the root has sent before all join at once goes to each by itself.
TEST(GroupCopies, OfMembersThatComeLateAFewAreServedAtATime) {
  constexpr std::size_t kLate = 12;
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team;
  for (std::size_t i = 0; i <= kLate; ++i) team.add(options);
  team.run_for(2s);
  team.send(0, "mc_robot_0", noise(300'000, 1), Priority::kBulk);
  team.run_for(1s);
  std::set<MacAddress> served;
  std::size_t arrived = 0;
  std::size_t most = 0;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const bool data = frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kData);
    if (robot != 0 || !data || frame.bytes.size() < 1000) return;  // an answer to who has joined
    served.insert(frame.destination);
    most = std::max(most, served.size() - arrived);
  };
  team.on_event = [&](std::size_t, const Event& event) {
    if (std::holds_alternative<PacketReceived>(event)) ++arrived;
  };
  for (std::size_t robot = 1; robot <= kLate; ++robot) team.engine(robot).join_group("mc_robot_0", team.now());
  EXPECT_TRUE(team.run_until_done([&] { return arrived == kLate; }, 30s));
  EXPECT_LE(most, 5u) << "four, and one may have arrived without the root's knowing";
  EXPECT_GE(most, 2u);
}

/// Who is served and cannot be reached holds the others up until the search for it has failed.
TEST(GroupCopies, MembersThatDieWhileTheyAreServedDoNotHoldUpTheOthersForLong) {
  MediumOptions medium;
  medium.bit_rate = 1e6;
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team(medium);
  for (std::size_t i = 0; i < 7; ++i) team.add(options);
  team.run_for(2s);
  team.send(0, "mc_robot_0", noise(50'000, 1));
  team.run_for(1s);
  std::set<MacAddress> receivers;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (robot == 0 && frame.bytes.size() >= 1000) receivers.insert(frame.destination);
  };
  for (std::size_t robot = 1; robot < 7; ++robot) team.engine(robot).join_group("mc_robot_0", team.now());
  const auto first = [&] { return receivers.size() == 4; };
  ASSERT_TRUE(team.run_until_done(first, 5s));
  for (std::size_t robot = 1; robot < 7; ++robot) {
    if (receivers.count(Team::address(robot)) != 0) team.kill(robot);
  }
  const auto others_are_served = [&] {
    std::size_t arrived = 0;
    for (std::size_t robot = 1; robot < 7; ++robot) arrived += team.received(robot).size();
    return arrived == 2;
  };
  EXPECT_FALSE(others_are_served());
  EXPECT_TRUE(team.run_until_done(others_are_served, 10s));
}

TEST(GroupCopies, OneThatStillWaitsWhenTheLifetimeIsOverIsNamed) {
  constexpr std::size_t kMembers = 10;
  MediumOptions medium;
  medium.bit_rate = 1e6;
  Team team(medium);
  for (std::size_t i = 0; i <= kMembers; ++i) team.add();
  team.run_for(5s);
  for (std::size_t robot = 1; robot <= kMembers; ++robot) team.engine(robot).leave_group("mc_robot_0", team.now());
  team.run_for(2s);
  team.send(0, "mc_robot_0", noise(50'000, 1));
  team.run_for(1s);
  for (std::size_t robot = 1; robot <= kMembers; ++robot) team.engine(robot).join_group("mc_robot_0", team.now());
  team.run_for(100ms);
  SendRequest request{"mc_robot_0", "topic", 'A', noise(50'000, 2)};
  request.lifetime = 200ms;
  const SendId id = team.send(0, request);
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 5s));
  const SendFinished& end = *team.finished(0, id);
  EXPECT_FALSE(end.delivered);
  for (std::size_t robot = 1; robot <= kMembers; ++robot) {
    EXPECT_NE(end.reason.find(Team::name(robot)), std::string::npos) << end.reason;
  }
  team.run_for(30s);
  for (std::size_t robot = 1; robot <= kMembers; ++robot) {
    ASSERT_EQ(team.received(robot).size(), 1u) << robot << ": the packet before, in full";
  }
  const SendId next = team.send(0, "mc_robot_0", noise(1000, 3));
  EXPECT_TRUE(team.run_until_done([&] { return team.finished(0, next) != nullptr; }, 10s));
  EXPECT_TRUE(team.finished(0, next)->delivered);
}

}  // namespace
}  // namespace adhoc_communication
