// What is carried when, with which definition; nothing of ROS, time is a number.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>

#include "relay/relay_table.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

const std::string kMd5sum(32, 'a');

RelayTable::Message message(const std::string& octets, const std::string& type = "pkg/Type") {
  return std::make_shared<SerializedMessage>(
      SerializedMessage{type, kMd5sum, "float64 x", Bytes(octets.begin(), octets.end())});
}

RelayEntry to(const std::string& destination, const std::string& topic = "scan") {
  RelayEntry entry;
  entry.topic = topic;
  entry.destination = destination;
  return entry;
}

char type_of(const RelayTable::Transfer& transfer) { return static_cast<char>(transfer.request.payload_type); }

/// The message in a transfer, with or without its definition.
SerializedMessage content(const RelayTable::Transfer& transfer) {
  PacketReceived packet;
  packet.payload_type = transfer.request.payload_type;
  packet.payload = transfer.request.payload;
  return decode_any_message(packet);
}

std::string octets(const RelayTable::Transfer& transfer) {
  const SerializedMessage sent = content(transfer);
  return {sent.bytes.begin(), sent.bytes.end()};
}

/// Everything that can be sent now, each delivered at once.
std::vector<std::string> deliver_all(RelayTable& table, Time now) {
  std::vector<std::string> sent;
  while (const auto transfer = table.next(now)) {
    sent.push_back(octets(*transfer));
    table.finished(transfer->number, true, "", now);
  }
  return sent;
}

RelayReport only_report(const RelayTable& table) {
  const auto reports = table.reports();
  EXPECT_EQ(reports.size(), 1u);
  return reports.at(0);
}

TEST(RelayTable, DefinitionGoesOncePerDestinationAndType) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  const auto first = table.next(0s);
  ASSERT_TRUE(first);
  EXPECT_EQ(type_of(*first), 'X');
  EXPECT_EQ(content(*first).definition, "float64 x");
  table.offer(id, message("2"), 0s);
  EXPECT_FALSE(table.next(0s)) << "sent while it is open whether bob has the definition";
  table.finished(first->number, true, "", 1s);
  const auto second = table.next(1s);
  ASSERT_TRUE(second);
  EXPECT_EQ(type_of(*second), 'x');
  EXPECT_EQ(content(*second).definition, "");
  EXPECT_EQ(octets(*second), "2");
  table.offer(id, message("3", "pkg/Other"), 1s);
  EXPECT_EQ(type_of(*table.next(1s)), 'X');
}

TEST(RelayTable, RelaysOfOneTypeShareTheLesson) {
  RelayTable table("self");
  const auto a = table.add(to("bob", "a"));
  const auto b = table.add(to("bob", "b"));
  table.robot_appeared("bob", 0s);
  table.offer(a, message("1"), 0s);
  table.offer(b, message("2"), 0s);
  const auto first = table.next(0s);
  ASSERT_TRUE(first);
  EXPECT_FALSE(table.next(0s));
  table.finished(first->number, true, "", 0s);
  EXPECT_EQ(type_of(*table.next(0s)), 'x');
}

TEST(RelayTable, DefinitionGoesAgainAfterAFailureALossAndARestart) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  const auto failed = table.next(0s);
  table.finished(failed->number, false, "no route", 1s);
  table.offer(id, message("2"), 1s);
  const auto taught = table.next(1s);
  EXPECT_EQ(type_of(*taught), 'X');
  table.finished(taught->number, true, "", 1s);
  table.robot_lost("bob");
  table.robot_appeared("bob", 2s);
  table.offer(id, message("3"), 2s);
  EXPECT_EQ(type_of(*table.next(2s)), 'X');
}

TEST(RelayTable, DeliveryToAFormerRunTeachesNothing) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  const auto transfer = table.next(0s);
  table.robot_lost("bob");
  table.robot_appeared("bob", 0s);
  table.finished(transfer->number, true, "", 0s);
  table.offer(id, message("2"), 0s);
  EXPECT_EQ(type_of(*table.next(0s)), 'X');
}

TEST(RelayTable, BroadcastCarriesItsDefinitionAlways) {
  RelayTable table("self");
  const auto id = table.add(to(""));
  for (int i = 0; i < 3; ++i) {
    table.offer(id, message("1"), 0s);
    const auto transfer = table.next(0s);
    ASSERT_TRUE(transfer);
    EXPECT_EQ(type_of(*transfer), 'X');
    table.finished(transfer->number, true, "", 0s);
  }
}

TEST(RelayTable, SlowRelayDropsTheOldestAndCounts) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  const int count = static_cast<int>(RelayQueue::kMostWaiting) + 4;
  for (int i = 0; i < count; ++i) table.offer(id, message(std::to_string(i)), 0s);
  EXPECT_EQ(only_report(table).waiting, RelayQueue::kMostWaiting);
  EXPECT_EQ(only_report(table).dropped, 4u);
  const auto sent = deliver_all(table, 0s);
  ASSERT_EQ(sent.size(), RelayQueue::kMostWaiting);
  EXPECT_EQ(sent.front(), "4");
  EXPECT_EQ(sent.back(), std::to_string(count - 1));
  EXPECT_EQ(only_report(table).delivered, RelayQueue::kMostWaiting);
}

TEST(RelayTable, OctetsAreBoundedOverAllRelays) {
  RelayTable table("self");
  std::vector<RelayTable::Id> ids;
  for (const char* topic : {"a", "b", "c", "d", "e", "f", "g", "h"}) {
    RelayEntry entry = to("bob", topic);
    entry.latched = true;
    ids.push_back(table.add(entry));
  }
  table.robot_appeared("bob", 0s);
  const auto large = message(std::string(3'000'000, 'x'));
  for (int round = 0; round < 10; ++round) {
    for (const auto id : ids) table.offer(id, large, 0s);
    std::size_t waiting = 0;
    for (const auto& report : table.reports()) waiting += report.octets;
    ASSERT_LE(waiting, RelayTable::kMostOctets);
  }
  std::uint64_t dropped = 0;
  for (const auto& report : table.reports()) dropped += report.dropped;
  EXPECT_GT(dropped, 0u);
  EXPECT_FALSE(deliver_all(table, 0s).empty());
  // All room is given back: as much fits again.
  for (const auto& report : table.reports()) table.remove(report.entry.topic, "bob", "");
  const auto again = table.add(to("bob", "again"));
  table.offer(again, message(std::string(RelayTable::kMostOctets, 'x')), 1s);
  EXPECT_EQ(only_report(table).waiting, 1u);
}

TEST(RelayTable, AtMostFourOfARelayAreOnTheWay) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  table.offer(id, message("taught"), 0s);
  deliver_all(table, 0s);
  for (int i = 0; i < 10; ++i) table.offer(id, message("m"), 0s);
  int started = 0;
  while (table.next(0s)) ++started;
  EXPECT_EQ(started, static_cast<int>(RelayQueue::kMostInFlight));
}

/// They were in memory beside the requests until the sends ended, outside of all bounds.
TEST(RelayTable, OctetsOfMessagesOnTheirWayAreNotKept) {
  for (const bool latched : {false, true}) {
    RelayTable table("self");
    RelayEntry entry = to("bob");
    entry.latched = latched;
    const auto id = table.add(entry);
    table.robot_appeared("bob", 0s);
    RelayTable::Message offered = message("octets");
    const std::weak_ptr<const SerializedMessage> kept = offered;
    table.offer(id, std::move(offered), 0s);
    const auto under_way = table.next(0s);
    ASSERT_TRUE(under_way);
    EXPECT_EQ(kept.expired(), !latched) << "a latched relay keeps its newest";
    table.offer(id, message("newer"), 0s);
    EXPECT_TRUE(kept.expired()) << "latched " << latched;
    table.finished(under_way->number, false, "no route", 0s);
    EXPECT_EQ(only_report(table).failed, 1u);
  }
}

TEST(RelayTable, OneRelayDoesNotStarveAnother) {
  RelayTable table("self");
  const auto a = table.add(to("bob", "a"));
  const auto b = table.add(to("carol", "b"));
  table.robot_appeared("bob", 0s);
  table.robot_appeared("carol", 0s);
  for (int i = 0; i < 5; ++i) {
    table.offer(a, message("a"), 0s);
    table.offer(b, message("b"), 0s);
  }
  const auto sent = deliver_all(table, 0s);
  EXPECT_EQ(std::vector<std::string>(sent.begin(), sent.begin() + 4), (std::vector<std::string>{"a", "b", "a", "b"}));
}

TEST(RelayTable, RateCarriesTheNewestWhenItsTimeHasCome) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.rate = 2.0;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  std::vector<std::string> sent;
  for (int tick = 0; tick < 100; ++tick) {
    const Time now = tick * 10ms;
    table.offer(id, message(std::to_string(tick)), now);
    for (const auto& octets : deliver_all(table, now)) sent.push_back(octets);
  }
  EXPECT_EQ(table.next_deadline(), 1s);
  for (const auto& octets : deliver_all(table, 1s)) sent.push_back(octets);
  EXPECT_EQ(sent, (std::vector<std::string>{"0", "50", "99"}));
  EXPECT_EQ(only_report(table).dropped, 0u) << "what the rate leaves out is no loss";
}

TEST(RelayTable, ReplacedMessagesGiveTheirRoomBack) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.rate = 1.0;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  const auto large = message(std::string(RelayTable::kMostOctets / 2, 'x'));
  for (int i = 0; i < 10; ++i) table.offer(id, large, 0s);
  EXPECT_EQ(only_report(table).waiting, 1u);
  EXPECT_EQ(only_report(table).dropped, 0u);
}

TEST(RelayTable, NothingIsSentToRobotsThatAreAway) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.offer(id, message("1"), 0s);
  EXPECT_FALSE(table.next(0s));
  EXPECT_EQ(only_report(table).dropped, 1u);
  table.robot_appeared("bob", 1s);
  EXPECT_FALSE(table.next(1s));
  table.offer(id, message("2"), 1s);
  EXPECT_EQ(deliver_all(table, 1s), std::vector<std::string>{"2"});
  table.offer(id, message("3"), 1s);
  table.robot_lost("bob");
  EXPECT_FALSE(table.next(2s));
  EXPECT_EQ(only_report(table).dropped, 2u);
}

TEST(RelayTable, LatchedMessageGoesToADestinationThatAppears) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.latched = true;
  const auto id = table.add(entry);
  table.offer(id, message("old"), 0s);
  table.offer(id, message("last"), 0s);
  EXPECT_EQ(only_report(table).dropped, 0u);
  table.robot_appeared("carol", 1s);
  EXPECT_FALSE(table.next(1s));
  table.robot_appeared("bob", 1s);
  EXPECT_EQ(deliver_all(table, 1s), std::vector<std::string>{"last"});
  table.robot_lost("bob");
  table.robot_appeared("bob", 2s);
  EXPECT_EQ(deliver_all(table, 2s), std::vector<std::string>{"last"});
}

TEST(RelayTable, LatchedMessageIsTriedAgainUntilItArrivesOrIsOutdated) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.latched = true;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  auto transfer = table.next(0s);
  table.finished(transfer->number, false, "no route", 0s);
  EXPECT_EQ(only_report(table).last_failure, "no route");
  EXPECT_FALSE(table.next(0s));
  EXPECT_EQ(table.next_deadline(), RelayQueue::kRetry);
  transfer = table.next(RelayQueue::kRetry);
  ASSERT_TRUE(transfer);
  table.offer(id, message("2"), RelayQueue::kRetry);
  table.finished(transfer->number, false, "no route", RelayQueue::kRetry);
  EXPECT_EQ(deliver_all(table, 10s), std::vector<std::string>{"2"});
}

TEST(RelayTable, LatchedMessageOfTheOwnGroupGoesToEachNewMemberAlone) {
  RelayTable table("self");
  RelayEntry entry = to("mc_self");
  entry.latched = true;
  const auto id = table.add(entry);
  table.offer(id, message("map"), 0s);
  const auto to_group = table.next(0s);
  ASSERT_TRUE(to_group);
  EXPECT_EQ(to_group->request.destination, "mc_self");
  table.finished(to_group->number, true, "", 0s);
  table.robot_appeared("bob", 1s);
  table.group_members({"bob"}, 1s);
  const auto to_bob = table.next(1s);
  ASSERT_TRUE(to_bob);
  EXPECT_EQ(to_bob->request.destination, "bob");
  table.finished(to_bob->number, true, "", 1s);
  table.group_members({"bob"}, 2s);
  EXPECT_FALSE(table.next(2s));
  table.group_members({}, 3s);
  table.group_members({"bob"}, 4s);
  EXPECT_TRUE(table.next(4s)) << "a member that has been away";
}

TEST(RelayTable, LatchedMessageThatFitsNoPacketIsNotTriedAgain) {
  RelayTable table("self", 1000);
  RelayEntry entry = to("bob");
  entry.latched = true;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  table.offer(id, message(std::string(1000, 'x')), 0s);
  const auto transfer = table.next(0s);
  ASSERT_TRUE(transfer);
  table.finished(transfer->number, false, "packet of 1.1 kB exceeds max_packet_size of 1.0 kB", 0s);
  EXPECT_EQ(only_report(table).failed, 1u);
  EXPECT_EQ(table.next_deadline(), Time::max());
  EXPECT_FALSE(table.next(10s));
  table.offer(id, message("1"), 11s);
  EXPECT_EQ(deliver_all(table, 11s), std::vector<std::string>{"1"});
}

/// As std_msgs/Empty.
TEST(RelayTable, LatchedMessageWithoutOctetsReachesWhoComesLate) {
  RelayTable table("self");
  RelayEntry entry = to("mc_self");
  entry.latched = true;
  const auto to_group = table.add(entry);
  entry.destination = "bob";
  const auto to_bob = table.add(entry);
  table.offer(to_group, message(""), 0s);
  table.offer(to_bob, message(""), 0s);
  EXPECT_EQ(deliver_all(table, 0s).size(), 1u);
  table.robot_appeared("bob", 1s);
  EXPECT_EQ(deliver_all(table, 1s), std::vector<std::string>{""});
  table.group_members({"bob"}, 2s);
  EXPECT_EQ(deliver_all(table, 2s), std::vector<std::string>{""});
}

/// Members that joined together pushed each other's message out of the queue.
TEST(RelayTable, LatchedMessageReachesManyWhoJoinTogether) {
  RelayTable table("self");
  RelayEntry entry = to("mc_self");
  entry.latched = true;
  const auto id = table.add(entry);
  table.offer(id, message("map"), 0s);
  deliver_all(table, 0s);
  std::vector<std::string> members;
  for (std::size_t i = 0; i < 3 * RelayQueue::kMostWaiting; ++i) members.push_back("robot_" + std::to_string(i));
  for (const std::string& member : members) table.robot_appeared(member, 1s);
  table.group_members(members, 1s);
  std::set<std::string> reached;
  for (Time now = 1s; now < 10s; now += RelayQueue::kRetry) {
    while (const auto transfer = table.next(now)) {
      const bool arrives = now > 1s || reached.size() % 2 == 0;
      if (arrives) reached.insert(transfer->request.destination);
      table.finished(transfer->number, arrives, "no route", now);
    }
  }
  EXPECT_EQ(reached, std::set<std::string>(members.begin(), members.end()));
  EXPECT_EQ(only_report(table).dropped, 0u);
}

TEST(RelayTable, NewMessageToTheGroupReachesLateMembersWithIt) {
  RelayTable table("self");
  RelayEntry entry = to("mc_self");
  entry.latched = true;
  const auto id = table.add(entry);
  table.offer(id, message("old"), 0s);
  deliver_all(table, 0s);
  table.robot_appeared("bob", 1s);
  table.group_members({"bob"}, 1s);
  table.offer(id, message("new"), 1s);
  const auto transfer = table.next(1s);
  ASSERT_TRUE(transfer);
  EXPECT_EQ(transfer->request.destination, "mc_self");
  EXPECT_FALSE(table.next(1s));
}

PacketReceived new_member(const std::string& root, const std::string& member) {
  PacketReceived word;
  word.source = root;
  word.payload_type = static_cast<std::uint8_t>(PayloadType::kNewMember);
  word.payload.assign(member.begin(), member.end());
  return word;
}

TEST(RelayTable, LatchedMessageOfAnotherGroupGoesToEachNewMemberAlone) {
  RelayTable table("self");
  RelayEntry entry = to("mc_alice");
  entry.latched = true;
  const auto id = table.add(entry);
  entry.topic = "not latched";
  entry.latched = false;
  const auto passing = table.add(entry);
  for (const char* robot : {"alice", "carol", "dave"}) table.robot_appeared(robot, 0s);
  for (const char* text : {"old", "new"}) table.offer(id, message(text), 0s);
  table.offer(passing, message("gone"), 0s);
  EXPECT_EQ(deliver_all(table, 0s).size(), 3u);
  table.new_member(new_member("alice", "carol"), 1s);
  table.new_member(new_member("alice", "self"), 1s);
  table.new_member(new_member("bob", "dave"), 1s);
  const auto transfer = table.next(1s);
  ASSERT_TRUE(transfer);
  EXPECT_EQ(transfer->request.destination, "carol");
  EXPECT_EQ(octets(*transfer), "new");
  EXPECT_EQ(type_of(*transfer), 'X') << "carol does not know what the group knows";
  EXPECT_FALSE(table.next(1s));
}

TEST(RelayTable, NewMembersAreServedWhenTheyAreThereAndBounded) {
  RelayTable table("self");
  RelayEntry entry = to("mc_alice");
  entry.latched = true;
  const auto id = table.add(entry);
  table.robot_appeared("alice", 0s);
  table.offer(id, message("1"), 0s);
  EXPECT_EQ(deliver_all(table, 0s).size(), 1u);
  for (int i = 0; i < 1000; ++i) table.new_member(new_member("alice", "robot_" + std::to_string(1000 + i)), 2s);
  EXPECT_FALSE(table.next(2s)) << "none of them is there";
  table.robot_appeared("robot_1007", 3s);
  const auto transfer = table.next(3s);
  ASSERT_TRUE(transfer);
  table.robot_lost("robot_1007");
  table.finished(transfer->number, false, "no route", 4s);
  EXPECT_FALSE(table.next(10s));
  for (int i = 0; i < 1000; ++i) table.robot_appeared("robot_" + std::to_string(1000 + i), 10s);
  EXPECT_EQ(deliver_all(table, 10s).size(), RelayQueue::kMostOwed);
}

/// The whole group was sent it anew once a second while one member was away, and when that came back, it got it by the
/// repetition and again when the root told of it.
TEST(RelayTable, WhatSomeOfAGroupMissedGoesToThemAloneAndOnce) {
  RelayTable table("self");
  RelayEntry entry = to("mc_alice");
  entry.latched = true;
  const auto id = table.add(entry);
  table.robot_appeared("alice", 0s);
  table.offer(id, message("1"), 0s);
  const auto to_group = table.next(0s);
  ASSERT_TRUE(to_group);
  table.finished(to_group->number, false, "not delivered to carol (no route)", 0s, {"carol"});
  EXPECT_FALSE(table.next(5s)) << "those who have it do not get it again";
  table.robot_appeared("carol", 6s);
  const auto to_carol = table.next(6s);
  ASSERT_TRUE(to_carol);
  EXPECT_EQ(to_carol->request.destination, "carol");
  table.new_member(new_member("alice", "carol"), 6s);
  table.finished(to_carol->number, true, "", 7s);
  table.new_member(new_member("alice", "carol"), 8s);
  EXPECT_FALSE(table.next(8s)) << "it has got it";
  table.robot_lost("carol");
  table.robot_appeared("carol", 9s);
  table.new_member(new_member("alice", "carol"), 9s);
  EXPECT_TRUE(table.next(9s)) << "another run of it has not";
}

/// A packet for the group of `self` as a relay of `source` sends it.
PacketReceived relayed(const std::string& source, bool latched) {
  PacketReceived packet;
  packet.source = source;
  packet.group = "mc_self";
  packet.payload_type = static_cast<std::uint8_t>(PayloadType::kMessageByType);
  packet.latched = latched;
  return packet;
}

/// The destinations of what is to be sent now, and the members named to them.
std::vector<std::string> words(RelayTable& table, Time now, bool delivered = true) {
  std::vector<std::string> result;
  std::vector<std::uint64_t> numbers;
  while (const auto transfer = table.next(now)) {
    EXPECT_EQ(type_of(*transfer), 'n');
    const Bytes& member = transfer->request.payload;
    result.push_back(transfer->request.destination + " " + std::string(member.begin(), member.end()));
    numbers.push_back(transfer->number);
  }
  for (const std::uint64_t number : numbers) table.finished(number, delivered, "", now);
  return result;
}

TEST(RelayTable, TheRootTellsSourcesOfLatchedMessagesOfNewMembers) {
  using Words = std::vector<std::string>;
  RelayTable table("self");
  table.group_packet(relayed("bob", true));
  table.group_packet(relayed("passing", false));
  PacketReceived of_another_group = relayed("dave", true);
  of_another_group.group = "mc_alice";
  table.group_packet(of_another_group);
  table.group_members({"bob", "carol"}, 0s);
  EXPECT_EQ(words(table, 0s), Words{"bob carol"});
  table.group_members({"bob", "carol"}, 1s);
  EXPECT_EQ(words(table, 1s), Words{});
  table.group_members({"bob", "carol", "erin"}, 2s);
  EXPECT_EQ(words(table, 2s, false), Words{"bob erin"});
  EXPECT_EQ(words(table, 2500ms), Words{});
  EXPECT_EQ(table.next_deadline(), 3s);
  EXPECT_EQ(words(table, 3s), Words{"bob erin"}) << "until it arrives";
  table.robot_lost("bob");
  table.group_members({"carol", "erin", "frank"}, 4s);
  EXPECT_EQ(words(table, 4s), Words{});
}

TEST(RelayTable, WordOfAMemberThatHasLeftIsNotRepeated) {
  RelayTable table("self");
  table.group_packet(relayed("bob", true));
  table.group_members({"carol"}, 0s);
  const auto word = table.next(0s);
  ASSERT_TRUE(word);
  table.group_members({}, 1s);
  table.finished(word->number, false, "", 1s);
  EXPECT_EQ(table.next_deadline(), Time::max());
}

TEST(RelayTable, WordsAndSourcesAreBounded) {
  RelayTable table("self");
  for (int i = 0; i < 1000; ++i) table.group_packet(relayed("source_" + std::to_string(i), true));
  std::vector<std::string> members;
  for (int i = 0; i < 200; ++i) members.push_back("member_" + std::to_string(i));
  table.group_members(members, 0s);
  std::size_t count = 0;
  while (const auto word = table.next(0s)) {
    table.finished(word->number, true, "", 0s);
    ++count;
  }
  EXPECT_EQ(count, GroupNews::kMostWords);
}

TEST(RelayTable, MessageIsOfNoUseAfterItsLifetime) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.latched = true;
  entry.lifetime = 0.5;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  const auto first = table.next(100ms);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->request.lifetime, 400ms);
  table.offer(id, message("2"), 100ms);
  table.finished(first->number, true, "", 700ms);
  EXPECT_FALSE(table.next(700ms)) << "its lifetime is over";
  EXPECT_EQ(only_report(table).dropped, 1u);
  table.robot_lost("bob");
  table.robot_appeared("bob", 800ms);
  EXPECT_FALSE(table.next(800ms)) << "also for those who come late";
}

TEST(RelayTable, NewestOnlyWaits) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.newest_only = true;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  table.offer(id, message("taught"), 0s);
  deliver_all(table, 0s);
  table.offer(id, message("1"), 0s);
  const auto begun = table.next(0s);
  ASSERT_TRUE(begun);
  EXPECT_TRUE(begun->request.newest_only);
  for (const char* octets : {"2", "3"}) table.offer(id, message(octets), 0s);
  const auto newest = table.next(0s);
  ASSERT_TRUE(newest);
  EXPECT_EQ(octets(*newest), "3");
  table.superseded(begun->number);
  table.finished(newest->number, true, "", 0s);
  const RelayReport report = only_report(table);
  EXPECT_EQ(report.delivered, 2u);
  EXPECT_EQ(report.failed + report.dropped, 0u);
}

TEST(RelayTable, RequestHasTopicPriorityAndDestinationOfItsEntry) {
  RelayTable table("self");
  RelayEntry entry = to("bob");
  entry.remote_topic = "/alice/scan";
  entry.priority = Priority::kPosition;
  const auto id = table.add(entry);
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  const auto transfer = table.next(0s);
  ASSERT_TRUE(transfer);
  EXPECT_EQ(transfer->request.topic, "/alice/scan");
  EXPECT_EQ(transfer->request.priority, Priority::kPosition);
  EXPECT_EQ(transfer->request.destination, "bob");
}

PacketReceived question(const std::string& type, const std::string& md5sum) {
  PacketReceived packet;
  packet.source = "carol";
  packet.payload_type = static_cast<std::uint8_t>(PayloadType::kDefinitionRequest);
  packet.payload = encode_message_by_type({type, md5sum, {}, {}, false});
  return packet;
}

TEST(RelayTable, AnswersWhoLacksADefinition) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.answer(question("pkg/Type", kMd5sum));
  EXPECT_EQ(table.next_deadline(), Time::max()) << "nothing of that type has come yet";
  table.offer(id, message("1"), 0s);
  table.answer(question("pkg/Type", std::string(32, 'b')));
  table.answer(question("pkg/Other", kMd5sum));
  EXPECT_FALSE(table.next(0s));
  table.answer(question("pkg/Type", kMd5sum));
  EXPECT_EQ(table.next_deadline(), Time::zero());
  const auto answer = table.next(0s);
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->request.destination, "carol");
  EXPECT_EQ(type_of(*answer), 'D');
  EXPECT_EQ(content(*answer).definition, "float64 x");
  EXPECT_EQ(octets(*answer), "");
  EXPECT_THROW(table.answer(question("none", kMd5sum)), PayloadError);
}

/// All but the first went by type only, and were lost at a receiver whom nobody could tell the definition.
TEST(RelayTable, MessagesOfAPublisherWithoutADefinitionAllGoInFull) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  table.robot_appeared("carol", 0s);
  const auto offer = [&](const char* octets, const char* definition) {
    const std::string text = octets;
    table.offer(id,
                std::make_shared<SerializedMessage>(
                    SerializedMessage{"pkg/Type", kMd5sum, definition, Bytes(text.begin(), text.end())}),
                0s);
  };
  const auto next_type = [&] {
    const auto transfer = table.next(0s);
    if (!transfer) return '-';
    table.finished(transfer->number, true, "", 0s);
    return type_of(*transfer);
  };
  offer("1", "");
  offer("2", "");
  const auto first = table.next(0s);
  EXPECT_EQ(next_type(), 'X') << "none waits for what another teaches";
  table.finished(first->number, true, "", 0s);
  offer("3", "");
  EXPECT_EQ(next_type(), 'X');
  table.answer(question("pkg/Type", kMd5sum));
  EXPECT_EQ(next_type(), '-') << "an empty definition is no answer";
  offer("4", "float64 x");
  EXPECT_EQ(next_type(), 'X') << "nobody has been taught it yet";
  offer("5", "float64 x");
  EXPECT_EQ(next_type(), 'x');
  table.answer(question("pkg/Type", kMd5sum));
  EXPECT_EQ(next_type(), 'D') << "another publisher gave it";
}

TEST(RelayTable, AsksAheadOfMessages) {
  RelayTable table("self");
  table.offer(table.add(to("bob")), message("1"), 0s);
  table.ask("carol", {"pkg/Type", kMd5sum});
  const auto question = table.next(0s);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->request.destination, "carol");
  EXPECT_EQ(type_of(*question), 'd');
  EXPECT_EQ(content(*question).type, "pkg/Type");
}

std::string refusal(RelayTable& table, const RelayEntry& entry) {
  try {
    table.add(entry);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(RelayTable, RefusesWithASentence) {
  RelayTable table("self");
  RelayEntry eternal = to("bob");
  eternal.lifetime = -1.0;
  EXPECT_EQ(refusal(table, eternal), "relay of 'scan' to 'bob' has a lifetime outside 0 .. 86400 s");
  EXPECT_EQ(refusal(table, to("self")), "relay of 'scan' to 'self' goes to this robot itself");
  for (const std::string& name :
       {std::string("no robot!"), std::string("mc_"), std::string("mc_a b"), std::string(65, 'x')}) {
    EXPECT_NE(refusal(table, to(name)).find("names no robot or group"), std::string::npos) << name;
  }
  RelayEntry fast = to("bob");
  for (const double rate : {-1.0, 1e9, std::numeric_limits<double>::quiet_NaN()}) {
    fast.rate = rate;
    EXPECT_EQ(refusal(table, fast), "relay of 'scan' to 'bob' has a rate outside 0 .. 1000 messages per second");
  }
  EXPECT_EQ(refusal(table, to("bob")), "");
  EXPECT_EQ(refusal(table, to("bob")), "relay of 'scan' to 'bob' exists already: remove it first to change it");
  for (std::size_t i = 1; i < RelayTable::kMostRelays; ++i) EXPECT_EQ(refusal(table, to("r" + std::to_string(i))), "");
  EXPECT_EQ(refusal(table, to("one_more")), "relay of 'scan' to 'one_more' would be one more than the 64 allowed");
}

TEST(RelayTable, RemovedRelayIsForgottenEvenWithAMessageOnItsWay) {
  RelayTable table("self");
  const auto id = table.add(to("bob"));
  table.robot_appeared("bob", 0s);
  table.offer(id, message("1"), 0s);
  const auto transfer = table.next(0s);
  table.offer(id, message("2"), 0s);
  EXPECT_TRUE(table.remove("scan", "carol", "").empty());
  EXPECT_TRUE(table.remove("scan", "bob", "other").empty());
  EXPECT_EQ(table.remove("scan", "bob", ""), std::vector<RelayTable::Id>{id});
  table.finished(transfer->number, true, "", 1s);
  table.offer(id, message("3"), 1s);
  EXPECT_FALSE(table.next(1s));
  EXPECT_TRUE(table.reports().empty());
  EXPECT_EQ(table.next_deadline(), Time::max());
}

}  // namespace
}  // namespace adhoc_communication
