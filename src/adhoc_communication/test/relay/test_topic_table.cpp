// Which topics are kept, and which messages wait for subscribers.
#include <gtest/gtest.h>

#include "fake_topics.hpp"
#include "relay/topic_table.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

class TopicTableTest : public testing::Test {
 protected:
  TopicTable::Topic& add(const std::string& name, Time now, const std::string& source = "bob",
                         std::size_t subscribers = 0) {
    return table.add(name, {"pkg/Type", "", source, local.advertise(name, {}, false), subscribers}, now);
  }
  void publish(const std::string& name, const std::string& octets, Time now) {
    table.publish(*table.find(name), {"pkg/Type", "", "", Bytes(octets.begin(), octets.end()), false}, now);
  }
  void release(Time now) { table.release_all(now); }

  FakeTopics local;
  std::vector<std::string>& published = local.published;
  std::map<std::string, std::size_t>& connected = local.connected;
  TopicTable table;
};

TEST_F(TopicTableTest, OneThatWaitsForSubscribersHoldsUpNoOther) {
  add("/slow", 0s, "bob", 1);
  add("/fast", 0s);
  publish("/slow", "1", 0s);
  publish("/fast", "1", 0s);
  publish("/slow", "2", 0s);
  EXPECT_EQ(published, std::vector<std::string>{"/fast 1"});
  EXPECT_TRUE(table.anything_waits());
  release(500ms);
  EXPECT_EQ(published.size(), 1u);
  connected["/slow"] = 1;
  release(510ms);
  publish("/slow", "3", 520ms);
  EXPECT_EQ(published, (std::vector<std::string>{"/fast 1", "/slow 1", "/slow 2", "/slow 3"}));
  EXPECT_FALSE(table.anything_waits());
}

/// To advertise a topic asks the master, which may hang.
TEST_F(TopicTableTest, MessagesWaitUntilTheirTopicIsOffered) {
  local.pending = {"/slow"};
  add("/slow", 0s, "bob", 1);
  add("/fast", 0s);
  publish("/slow", "1", 0s);
  publish("/fast", "1", 0s);
  release(4900ms);
  EXPECT_EQ(published, std::vector<std::string>{"/fast 1"});
  local.pending.clear();
  release(4950ms);
  release(5900ms);
  EXPECT_EQ(published.size(), 1u) << "its subscriber has a second from then on";
  connected["/slow"] = 1;
  release(5910ms);
  EXPECT_EQ(published, (std::vector<std::string>{"/fast 1", "/slow 1"}));
  local.pending = {"/never"};
  add("/never", 6s);
  publish("/never", "1", 6s);
  release(11s);
  EXPECT_FALSE(table.anything_waits()) << "not for ever";
}

TEST_F(TopicTableTest, SlowSubscribersAreServedUntilNothingWaits) {
  add("/map", 0s);
  local.slow.insert("/map");
  publish("/map", "1", 0s);
  EXPECT_TRUE(table.anything_waits());
  local.dropped["/map"] = 3;
  release(5ms);
  EXPECT_TRUE(table.anything_waits());
  const auto dropped = table.take_dropped();
  ASSERT_EQ(dropped.size(), 1u);
  EXPECT_EQ(dropped[0].topic, "/map");
  EXPECT_EQ(dropped[0].messages, 3u);
  EXPECT_TRUE(table.take_dropped().empty());
  local.slow.clear();
  release(10ms);
  EXPECT_FALSE(table.anything_waits());
}

TEST_F(TopicTableTest, LatchedMessagesAreBoundedByTheirOctets) {
  const auto keep = [&](const std::string& name, const std::string& source, Time now, std::size_t octets = 2'500'000) {
    if (!table.knows(name)) add(name, now, source).latched = true;
    table.publish(*table.find(name), {"pkg/Type", "", "", Bytes(octets), false}, now);
  };
  keep("/mine", "carol", 0s);
  for (int i = 0; i < 8; ++i) keep("/bomb_" + std::to_string(i), "bob", 1s + i * 1ms);
  EXPECT_EQ(table.size(), 3u) << "bob's share has room for two";
  EXPECT_TRUE(table.knows("/mine"));
  EXPECT_TRUE(table.knows("/bomb_7"));
  EXPECT_EQ(table.take_given_up().size(), 6u);
  for (int i = 0; i < 8; ++i) keep("/other_" + std::to_string(i), "dave_" + std::to_string(i), 2s + i * 1ms);
  EXPECT_EQ(table.size(), 4u);
  EXPECT_FALSE(table.knows("/bomb_6")) << "bob keeps most";
  for (int i = 0; i < 8; ++i) keep("/other_7", "dave_7", 3s + i * 1ms);
  EXPECT_EQ(table.size(), 4u);
  keep("/huge", "erin", 4s, 20'000'000);
  EXPECT_EQ(table.size(), 1u);
  EXPECT_TRUE(table.knows("/huge"));
}

TEST_F(TopicTableTest, SubscribersThatNeverConnectAreNotWaitedForForEver) {
  add("/slow", 0s, "bob", 1);
  publish("/slow", "1", 0s);
  release(TopicTable::kLongestConnection - 1ms);
  EXPECT_TRUE(published.empty());
  release(TopicTable::kLongestConnection);
  EXPECT_EQ(published.size(), 1u);
}

TEST_F(TopicTableTest, WhatWaitsIsBounded) {
  add("/slow", 0s, "bob", 1);
  for (std::size_t i = 0; i < TopicTable::kMostWaiting; ++i) publish("/slow", "x", 0s);
  EXPECT_EQ(published.size(), TopicTable::kMostWaiting);
  published.clear();
  add("/large", 0s, "bob", 1);
  publish("/large", std::string(TopicTable::kMostWaitingOctets, 'x'), 0s);
  EXPECT_EQ(published.size(), 1u);
  EXPECT_FALSE(table.anything_waits());
}

TEST_F(TopicTableTest, ARobotLosesItsOwnTopicsBeyondItsShare) {
  add("/honest", 0s, "alice");
  for (std::size_t i = 0; i < 2 * TopicTable::kMostTopics; ++i)
    add("/flood_" + std::to_string(i), 1s + i * 1ms, "mallory");
  EXPECT_EQ(table.size(), 1 + TopicTable::kMostOfASource);
  EXPECT_TRUE(table.knows("/honest"));
  EXPECT_FALSE(table.knows("/flood_0"));
  EXPECT_TRUE(table.knows("/flood_" + std::to_string(2 * TopicTable::kMostTopics - 1)));
}

TEST_F(TopicTableTest, TheLeastUsedMakesRoom) {
  const std::size_t share = TopicTable::kMostOfASource;
  for (std::size_t i = 0; i < TopicTable::kMostTopics; ++i) {
    add("/topic_" + std::to_string(i), i * 1ms, "robot_" + std::to_string(i / share));
  }
  publish("/topic_0", "x", 10s);
  table.find("/topic_1");
  add("/new", 11s, "robot_9");
  EXPECT_EQ(table.size(), TopicTable::kMostTopics);
  EXPECT_TRUE(table.knows("/topic_0"));
  EXPECT_FALSE(table.knows("/topic_1"));
}

TEST_F(TopicTableTest, AForgottenTopicTakesWhatWaitsWithIt) {
  add("/slow", 0s, "bob", 1);
  publish("/slow", "1", 0s);
  for (std::size_t i = 0; i < TopicTable::kMostOfASource; ++i) add("/topic_" + std::to_string(i), 1s);
  EXPECT_FALSE(table.anything_waits());
}

}  // namespace
}  // namespace adhoc_communication
