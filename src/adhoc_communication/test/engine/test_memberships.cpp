// What a robot is to the groups of others, and what the root of a group keeps of its members.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "multicast/group_sends.hpp"
#include "multicast/memberships.hpp"
#include "multicast/own_group.hpp"

namespace adhoc_communication::multicast {
namespace {

using namespace std::chrono_literals;
using Kind = Word::Kind;

constexpr char kGroup[] = "mc_root";
const MacAddress kRoot = {2, 0, 0, 0, 0, 1};

struct Fixture {
  explicit Fixture(bool automatic) : memberships(directory, load, automatic, 10) {}
  void root_is_heard(Time now) { directory.life_sign(kRoot, "root", 1, ++alive, 1, kRoot, false, now); }
  std::vector<Kind> words() {
    std::vector<Kind> kinds;
    for (const Word& word : memberships.take_words()) kinds.push_back(word.kind);
    return kinds;
  }
  routing::LivingRuns runs;
  routing::RobotDirectory directory{runs, "self"};
  routing::RequestLoad load;
  std::uint32_t alive = 0;
  Memberships memberships;
};

using Kinds = std::vector<Kind>;

TEST(Memberships, AJoinOfTheHostEndsWhenTheRootHasNamedThisRobot) {
  Fixture robot(false);
  robot.memberships.join(kGroup);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 1s);
  EXPECT_TRUE(robot.memberships.joined(kGroup));
  EXPECT_EQ(robot.words(), Kinds{Kind::kConfirmation});
  EXPECT_TRUE(robot.memberships.take_ends().empty());
  robot.memberships.named(kGroup, true, 1, 2s);
  const auto ends = robot.memberships.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_TRUE(ends[0].joined && ends[0].succeeded);
}

TEST(Memberships, AJoinThatIsNotConfirmedIsOver) {
  Fixture robot(false);
  robot.memberships.join(kGroup);
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 1s);
  robot.memberships.expire(1s + Memberships::kMembersPatience - 1ns);
  EXPECT_TRUE(robot.memberships.take_ends().empty());
  robot.memberships.expire(1s + Memberships::kMembersPatience);
  const auto ends = robot.memberships.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_FALSE(ends[0].succeeded);
  EXPECT_EQ(robot.memberships.size(), 0u);
}

TEST(Memberships, TheRootOfAJoinThatFailedIsToldToForgetIt) {
  Fixture robot(false);
  robot.root_is_heard(1s);
  robot.memberships.join(kGroup);
  robot.words();
  robot.memberships.said({Kind::kJoin, kGroup}, false, "no route", 1s);
  EXPECT_EQ(robot.words(), Kinds{Kind::kLeave}) << "the root may have heard of it all the same";
  EXPECT_TRUE(robot.memberships.takes_part(kGroup));
  EXPECT_TRUE(robot.memberships.refuses(kGroup));
  EXPECT_EQ(robot.memberships.take_ends().size(), 1u);
  robot.memberships.said({Kind::kLeave, kGroup}, true, {}, 2s);
  EXPECT_EQ(robot.memberships.size(), 0u);
}

TEST(Memberships, AConfirmationThatComesLateDoesNotEndAMembership) {
  Fixture robot(false);
  robot.root_is_heard(1s);
  robot.memberships.join(kGroup);
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 1s);
  robot.memberships.named(kGroup, true, 1, 2s);
  robot.words();
  robot.memberships.said({Kind::kConfirmation, kGroup}, false, "no route", 3s);
  EXPECT_TRUE(robot.memberships.joined(kGroup));
  EXPECT_EQ(robot.words(), Kinds{});
}

TEST(Memberships, WhatHappensByItselfIsTriedAgainWhenTheRootIsThere) {
  Fixture robot(true);
  robot.root_is_heard(1s);
  robot.memberships.appeared("root", 1s);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
  robot.memberships.said({Kind::kJoin, kGroup}, false, "no route", 2s);
  robot.memberships.expire(2s + Memberships::kRetry - 1ns);
  EXPECT_EQ(robot.words(), Kinds{});
  robot.memberships.expire(2s + Memberships::kRetry);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
  EXPECT_TRUE(robot.memberships.take_ends().empty()) << "nobody has asked";
}

/// So many roots, the nth n hops away, and what is said to them.
struct Crowd : Fixture {
  static constexpr int kRoots = 50;
  Crowd() : Fixture(true) {
    for (int i = 1; i <= kRoots; ++i) {
      const MacAddress address{2, 0, 0, 0, 1, static_cast<std::uint8_t>(i)};
      directory.life_sign(address, "r" + std::to_string(i), 1, 1, static_cast<std::uint8_t>(i), kRoot, false, 1s);
    }
    for (int i = kRoots; i >= 1; --i) memberships.appeared("r" + std::to_string(i), 1s);
  }
};

/// The joins of a large team that were all under way at once took the air that each of them needed.
TEST(Memberships, JoinsByThemselvesGoOneAfterTheOtherTheNearestFirst) {
  Crowd robot;
  std::vector<std::string> joined;
  std::set<std::string> under_way;
  Time now = 1s;
  for (; joined.size() < Crowd::kRoots && now < 60s; now += 50ms) {
    robot.memberships.expire(now);
    for (const Word& word : robot.memberships.take_words()) {
      joined.push_back(word.group);
      under_way.insert(word.group);
    }
    EXPECT_LE(under_way.size(), static_cast<std::size_t>(Memberships::kJoinsAtOnce));
    const std::set<std::string> arrived = std::exchange(under_way, {});
    for (const std::string& group : arrived) robot.memberships.said({Kind::kJoin, group}, true, {}, now);
  }
  ASSERT_EQ(joined.size(), static_cast<std::size_t>(Crowd::kRoots));
  const Time least = (Crowd::kRoots - 1) * Crowd::kRoots * Memberships::kJoinSpacing - Memberships::kJoinBurst;
  EXPECT_GE(now - 1s, least);
  EXPECT_LE(now - 1s, least + 1s);
  for (std::size_t i = 1; i < joined.size(); ++i) EXPECT_EQ(joined[i], "mc_r" + std::to_string(i)) << "the nearest";
}

TEST(Memberships, OfJoinsThatTakeLongFewAreUnderWay) {
  Crowd robot;
  std::size_t words = 0;
  for (Time now = 1s; now < 60s; now += 250ms) {
    robot.memberships.expire(now);
    words += robot.memberships.take_words().size();
  }
  EXPECT_EQ(words, 2u) << "the first counts as three when the third would begin";
}

/// How many joins have begun within ten seconds, each of which takes that long.
int joins_of(Time each) {
  Crowd robot;
  std::map<Time, std::string> ends;
  int begun = 0;
  for (Time now = 1s; now < 11s; now += 10ms) {
    robot.memberships.expire(now);
    for (; !ends.empty() && ends.begin()->first <= now; ends.erase(ends.begin())) {
      robot.memberships.said({Kind::kJoin, ends.begin()->second}, true, {}, now);
    }
    for (const Word& word : robot.memberships.take_words()) {
      ++begun;
      for (Time end = now + each; !ends.emplace(end, word.group).second;) end += 1ns;
    }
  }
  return begun;
}

/// Joins went on at the same pace while packets of users found no air; each of them cost the more.
TEST(Memberships, JoinsThatTakeLongMakeRoomForOthers) {
  const int quick = joins_of(Memberships::kSlowJoin / 2);
  EXPECT_GE(quick, 10s / (Crowd::kRoots * Memberships::kJoinSpacing));
  EXPECT_LE(joins_of(2 * Memberships::kSlowJoin), quick / 3);
}

/// The slow ones alone told it: by the time that enough of them had ended, hundreds of others were under way.
TEST(Memberships, WhileSearchesFillTheAirJoinsAreRare) {
  Crowd robot;
  std::vector<Time> begun;
  for (Time now = 1s; now < 31s; now += 10ms) {
    const bool crowded = now < 21s;
    for (std::size_t i = 0; crowded && i < routing::RequestLoad::kFull / 99; ++i) robot.load.heard(now);
    robot.memberships.expire(now);
    for (const Word& word : robot.memberships.take_words()) {
      begun.push_back(now);
      robot.memberships.said({Kind::kJoin, word.group}, true, {}, now + 1ms);
    }
  }
  const auto later = std::find_if(begun.begin(), begun.end(), [](Time at) { return at >= 3s; });
  const auto after = std::find_if(later, begun.end(), [](Time at) { return at >= 21s; });
  EXPECT_LE(after - later, 18s / Memberships::kLongestSpacing + 1);
  EXPECT_GE(after - later, 3) << "all are joined some day";
  EXPECT_EQ(begun.size(), static_cast<std::size_t>(Crowd::kRoots));
}

/// Robots that are there, near by, and never answer took every turn: nobody else was joined for ever.
TEST(Memberships, RootsThatDoNotAnswerWaitBehindTheOthers) {
  Crowd robot;
  constexpr int kDumb = 7;
  std::multimap<Time, std::string> ends;
  std::set<std::string> joined;
  for (Time now = 1s; now < 120s; now += 50ms) {
    robot.memberships.expire(now);
    for (; !ends.empty() && ends.begin()->first <= now; ends.erase(ends.begin())) {
      const std::string& group = ends.begin()->second;
      const bool answers = std::stoi(group.substr(4)) > kDumb;
      if (answers) joined.insert(group);
      robot.memberships.said({Kind::kJoin, group}, answers, "no route", now);
    }
    for (const Word& word : robot.memberships.take_words()) {
      const bool answers = std::stoi(word.group.substr(4)) > kDumb;
      ends.emplace(now + (answers ? 50ms : 3s), word.group);
    }
  }
  EXPECT_EQ(joined.size(), static_cast<std::size_t>(Crowd::kRoots - kDumb));
}

TEST(Memberships, AJoinThatFailsAgainAndAgainIsTriedLessAndLess) {
  Fixture robot(true);
  robot.root_is_heard(1s);
  robot.memberships.appeared("root", 1s);
  std::vector<Time> tries;
  for (Time now = 1s; tries.size() < 8; now += 250ms) {
    robot.memberships.expire(now);
    for ([[maybe_unused]] const Word& word : robot.memberships.take_words()) {
      tries.push_back(now);
      robot.memberships.said({Kind::kJoin, kGroup}, false, "no route", now);
    }
  }
  const Time longest = Memberships::kRetry * (1 << Memberships::kMostDoublings);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(tries[i + 1] - tries[i], std::min(longest, Memberships::kRetry * (1 << i)));
}

TEST(Memberships, ARootThatComesBackIsAskedAtOnce) {
  Fixture robot(true);
  robot.root_is_heard(1s);
  robot.memberships.appeared("root", 1s);
  for (Time now : {1s, 4s, 10s}) {
    robot.memberships.expire(now);
    EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
    robot.memberships.said({Kind::kJoin, kGroup}, false, "no route", now);
  }
  robot.memberships.lost("root");
  robot.memberships.appeared("root", 11s);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
}

TEST(Memberships, AFullRootIsNotAskedAgainSoon) {
  Fixture robot(true);
  robot.root_is_heard(1s);
  robot.memberships.appeared("root", 1s);
  robot.words();
  robot.memberships.named(kGroup, false, 10, 2s);  // overtakes the acknowledgment of the join
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 2s);
  EXPECT_FALSE(robot.memberships.joined(kGroup));
  robot.memberships.expire(2s + Memberships::kFullRetry - 1ns);
  EXPECT_EQ(robot.words(), Kinds{});
  robot.memberships.expire(2s + Memberships::kFullRetry);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
}

TEST(Memberships, ALeaveLastsAndIsToldUntilTheRootHasHeardOfIt) {
  Fixture robot(true);
  robot.root_is_heard(1s);
  robot.memberships.appeared("root", 1s);
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 1s);
  robot.words();
  robot.memberships.leave(kGroup);
  EXPECT_EQ(robot.words(), Kinds{Kind::kLeave});
  EXPECT_TRUE(robot.memberships.refuses(kGroup));
  EXPECT_TRUE(robot.memberships.takes_part(kGroup)) << "the root does not know yet";
  robot.memberships.said({Kind::kLeave, kGroup}, false, "no route", 2s);
  robot.memberships.expire(2s + Memberships::kRetry);
  EXPECT_EQ(robot.words(), Kinds{Kind::kLeave});
  robot.memberships.said({Kind::kLeave, kGroup}, true, {}, 5s);
  EXPECT_FALSE(robot.memberships.takes_part(kGroup));
  robot.memberships.appeared("root", 1s);
  robot.memberships.expire(100s);
  EXPECT_EQ(robot.words(), Kinds{});
}

TEST(Memberships, ALeaveHoldsAgainAfterAJoinThatFails) {
  Fixture robot(true);
  robot.root_is_heard(1s);
  robot.memberships.appeared("root", 1s);
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 1s);
  robot.memberships.leave(kGroup);
  robot.memberships.said({Kind::kLeave, kGroup}, true, {}, 2s);
  robot.words();
  robot.memberships.join(kGroup);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
  robot.memberships.said({Kind::kJoin, kGroup}, false, "no route", 3s);
  EXPECT_EQ(robot.words(), Kinds{Kind::kLeave}) << "the root may have heard of the join";
  robot.memberships.said({Kind::kLeave, kGroup}, true, {}, 4s);
  EXPECT_TRUE(robot.memberships.refuses(kGroup));
  robot.memberships.appeared("root", 1s);
  robot.memberships.expire(100s);
  EXPECT_EQ(robot.words(), Kinds{});
  robot.memberships.join(kGroup);
  robot.memberships.said({Kind::kJoin, kGroup}, true, {}, 101s);
  robot.memberships.named(kGroup, true, 1, 101s);
  EXPECT_TRUE(robot.memberships.joined(kGroup));
  EXPECT_FALSE(robot.memberships.refuses(kGroup));
}

TEST(Memberships, AnotherRunKeepsWhatTheHostWanted) {
  Fixture former(true), robot(true);
  former.memberships.join("mc_a");
  former.memberships.join("mc_b");
  former.memberships.leave("mc_b");
  former.memberships.take_ends();
  former.memberships.end("restart");
  ASSERT_EQ(former.memberships.take_ends().size(), 1u) << "the join of mc_a";
  robot.memberships.succeed(former.memberships);
  EXPECT_FALSE(robot.memberships.refuses("mc_a"));
  EXPECT_TRUE(robot.memberships.refuses("mc_b"));
  EXPECT_TRUE(robot.memberships.groups().empty()) << "the root has not heard of this run";
}

TEST(Memberships, AJoinThatEndsWithTheRunIsNotTakenOver) {
  Fixture robot(false);
  robot.root_is_heard(1s);
  robot.memberships.join(kGroup);
  robot.memberships.end("the interface has changed");
  EXPECT_EQ(robot.memberships.take_ends().size(), 1u);
  Fixture next(false);
  next.memberships.succeed(robot.memberships);
  next.root_is_heard(2s);
  next.memberships.appeared("root", 2s);
  EXPECT_EQ(next.words(), Kinds{}) << "the host was told that it failed";
}

TEST(Memberships, GroupsOfRobotsThatNobodyKnowsAreForgotten) {
  Fixture robot(true);
  for (std::size_t i = 0; i < Memberships::kMostGroups; ++i) {
    robot.memberships.appeared("rumour_" + std::to_string(i), 1s);
  }
  robot.root_is_heard(2s);
  robot.memberships.appeared("root", 2s);
  EXPECT_EQ(robot.memberships.find(kGroup), nullptr) << "no room";
  robot.memberships.expire(3s);
  EXPECT_EQ(robot.memberships.size(), 0u);
  robot.memberships.appeared("root", 3s);
  EXPECT_EQ(robot.words(), Kinds{Kind::kJoin});
}

TEST(Memberships, TheTableIsBounded) {
  Fixture robot(false);
  for (std::size_t i = 0; i <= Memberships::kMostGroups; ++i) robot.memberships.join("mc_" + std::to_string(i));
  EXPECT_EQ(robot.memberships.size(), Memberships::kMostGroups);
  const auto ends = robot.memberships.take_ends();
  ASSERT_EQ(ends.size(), 1u);
  EXPECT_FALSE(ends[0].succeeded);
}

HeldPacket packet(std::uint32_t number, std::size_t octets, Time sent, Time until = Time::max()) {
  return {0, number, std::make_shared<const Bytes>(octets), sent, until};
}

TEST(OwnGroup, ALostMemberComesBackOnlyAsTheSameRun) {
  OwnGroup group(1000);
  EXPECT_EQ(group.admit("a", 7), OwnGroup::Admission::kNew);
  EXPECT_EQ(group.admit("a", 7), OwnGroup::Admission::kKnown);
  EXPECT_TRUE(group.lose("a", 7));
  EXPECT_FALSE(group.holds("a"));
  EXPECT_FALSE(group.comes_back("a", 8)) << "another run has to join";
  group.admit("a", 7);
  group.lose("a", 7);
  EXPECT_TRUE(group.comes_back("a", 7));
  group.admit("a", 7);
  group.lose("a", 7);
  group.leave("a");
  EXPECT_FALSE(group.comes_back("a", 7)) << "it has left meanwhile";
}

/// Its join came before the loss of the former run was told, which then took the new one for the former.
TEST(OwnGroup, ARunThatJoinsBeforeTheFormerIsLostStays) {
  OwnGroup group(1000);
  group.admit("a", 7);
  group.copy_started("a", packet(1, 100, 0s));
  EXPECT_EQ(group.admit("a", 8), OwnGroup::Admission::kRestarted);
  EXPECT_FALSE(group.served_by_copies("a")) << "those were for the former run";
  EXPECT_FALSE(group.lose("a", 7));
  EXPECT_TRUE(group.holds("a"));
}

TEST(OwnGroup, AMemberThatNobodyKnowsIsLost) {
  OwnGroup group(1000);
  group.admit("a", 1);
  group.admit("b", 2);
  group.lose_if([](const std::string& robot) { return robot == "a"; });
  EXPECT_EQ(group.names(), std::vector<std::string>{"b"});
  EXPECT_TRUE(group.comes_back("a", 1));
}

TEST(OwnGroup, OfTooManyLostTheOneLostLongestAgoHasToJoinAgain) {
  OwnGroup group(10'000);
  const auto lose = [&](std::size_t number) {
    group.admit("robot_" + std::to_string(number), 7);
    group.lose("robot_" + std::to_string(number), 7);
  };
  for (std::size_t number = 0; number <= OwnGroup::kMostAbsent; ++number) lose(number);
  lose(1);  // once more: the latest
  EXPECT_EQ(group.absent(), OwnGroup::kMostAbsent);
  lose(1000);
  EXPECT_EQ(group.absent(), OwnGroup::kMostAbsent);
  EXPECT_FALSE(group.comes_back("robot_0", 7));
  EXPECT_FALSE(group.comes_back("robot_2", 7));
  EXPECT_TRUE(group.comes_back("robot_1", 7));
  EXPECT_TRUE(group.comes_back("robot_3", 7));
}

TEST(OwnGroup, HasTheMembersThatOneActivationNames) {
  OwnGroup group(13);
  EXPECT_EQ(group.most(), 2u);
  group.admit("a", 7);
  group.admit("b", 7);
  EXPECT_EQ(group.admit("c", 7), OwnGroup::Admission::kFull);
  EXPECT_EQ(group.names(), (std::vector<std::string>{"a", "b"}));
}

TEST(OwnGroup, ServesAMemberByCopiesUntilTheLastHasEnded) {
  OwnGroup group(1000);
  group.admit("a", 7);
  group.leave_out("a");
  group.copy_started("a", packet(1, 100, 0s));
  group.copy_started("a", packet(2, 100, 0s));
  group.copy_finished("a", 0, 1);
  EXPECT_TRUE(group.served_by_copies("a"));
  group.copy_finished("a", 0, 2);
  EXPECT_FALSE(group.served_by_copies("a"));
}

TEST(OwnGroup, ACopyOfAFloodedPacketLeavesNobodyOut) {
  OwnGroup group(1000);
  group.admit("a", 7);
  group.copy_started("a", packet(1, 100, 0s));
  EXPECT_FALSE(group.served_by_copies("a"));
  group.leave_out("a");
  group.take_back("a");
  EXPECT_FALSE(group.served_by_copies("a")) << "the next flood reaches it";
}

/// Where packets follow each other closely, one is always on its way.
TEST(OwnGroup, AnotherTreeTakesAMemberBackWhoseCopiesAreNotLate) {
  OwnGroup group(1000);
  group.admit("a", 7);
  group.leave_out("a");
  group.copy_started("a", packet(1, 100, 0s));
  group.take_back_punctual(100ms);
  EXPECT_TRUE(group.served_by_copies("a")) << "it is the tree that has left it out";
  group.tree_built();
  group.leave_out("a");
  group.copy_started("a", packet(2, 100, 200ms));
  group.take_back_punctual(OwnGroup::kPunctual);
  EXPECT_TRUE(group.served_by_copies("a")) << "what comes along the tree would wait for the first one";
  group.copy_finished("a", 0, 1);
  group.take_back_punctual(OwnGroup::kPunctual);
  EXPECT_FALSE(group.served_by_copies("a"));

  group.leave_out("a");
  group.copy_started("a", packet(3, 100, 1s));
  group.copy_finished("a", 0, 2);
  group.take_back_punctual(1s);
  EXPECT_TRUE(group.served_by_copies("a")) << "the new one has left it out, too";
}

TEST(OwnGroup, KeepsPacketsForNewcomersWhileTheyAreOfUse) {
  OwnGroup group(1000);
  group.hold(packet(1, 100, 0s), 0s);
  group.hold(packet(2, 100, 1s, 2s), 1s);
  EXPECT_EQ(group.held_for_newcomers(1s).size(), 2u);
  EXPECT_EQ(group.held_for_newcomers(2s).size(), 1u) << "the lifetime of one is over";
  EXPECT_EQ(group.held_for_newcomers(OwnGroup::kHeld).size(), 0u);
  group.hold(packet(3, OwnGroup::kMostHeldOctets - 100, 1s), 1s);
  EXPECT_EQ(group.held_for_newcomers(1s).size(), 2u) << "the oldest made room";
}

TEST(GroupSends, EachHasItsOwnPatienceAndTheRootIsAskedAgainForTheOthers) {
  GroupSends sends;
  const auto image = std::make_shared<const Bytes>(10);
  EXPECT_TRUE(sends.wait(kGroup, {1, image, Priority::kNormal, 5s}));
  EXPECT_FALSE(sends.wait(kGroup, {2, image, Priority::kNormal, 7s}));
  EXPECT_TRUE(sends.take_overdue(4s).sends.empty());
  auto overdue = sends.take_overdue(5s);
  EXPECT_EQ(overdue.sends, std::vector<SendId>{1});
  EXPECT_EQ(overdue.groups_to_ask, std::vector<std::string>{kGroup});
  overdue = sends.take_overdue(7s);
  EXPECT_EQ(overdue.sends, std::vector<SendId>{2});
  EXPECT_TRUE(overdue.groups_to_ask.empty());
  EXPECT_TRUE(sends.wait(kGroup, {3, image, Priority::kNormal, 20s})) << "nothing waits any more";
}

TEST(GroupSends, AFanOutEndsWithItsLastMember) {
  GroupSends sends;
  sends.fan_out(1, 3);
  EXPECT_FALSE(sends.part_finished(1, "a", false, "far"));
  EXPECT_FALSE(sends.part_finished(1, "b", true, {}));
  const auto missed = sends.part_finished(1, "c", false, "lost");
  ASSERT_TRUE(missed);
  EXPECT_EQ(missed->text, "a (far), c (lost)");
  EXPECT_EQ(missed->members, (std::vector<std::string>{"a", "c"}));
  EXPECT_FALSE(sends.part_finished(1, "c", true, {})) << "it has ended";
}

}  // namespace
}  // namespace adhoc_communication::multicast
