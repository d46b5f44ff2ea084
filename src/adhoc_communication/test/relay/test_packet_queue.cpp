// Whose packets are published next, and whose are dropped.
#include <gtest/gtest.h>

#include <algorithm>

#include "relay/packet_queue.hpp"

namespace adhoc_communication {
namespace {

PacketReceived packet(const std::string& source, const std::string& topic, std::size_t octets = 10,
                      std::uint32_t unpacked = 0) {
  PacketReceived result;
  result.source = source;
  result.topic = topic;
  result.payload.resize(octets);
  result.unpacked_size = unpacked;
  return result;
}

std::vector<std::string> order(PacketQueue& queue) {
  std::vector<std::string> topics;
  while (!queue.empty()) topics.push_back(queue.take().topic);
  return topics;
}

TEST(PacketQueue, PacketsOfOneRobotStayInOrder) {
  PacketQueue queue;
  for (const char* topic : {"a", "b", "c"}) EXPECT_TRUE(queue.add(packet("bob", topic)).empty());
  EXPECT_EQ(queue.size(), 3u);
  EXPECT_EQ(queue.octets(), 30u);
  EXPECT_EQ(order(queue), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(queue.octets(), 0u);
}

/// Who sent a thousand held up all others.
TEST(PacketQueue, RobotsTakeTurns) {
  PacketQueue queue;
  for (int i = 0; i < 500; ++i) queue.add(packet("mallory", "m"));
  queue.add(packet("bob", "b"));
  const std::vector<std::string> topics = order(queue);
  EXPECT_LE(std::find(topics.begin(), topics.end(), "b") - topics.begin(), 1);
}

/// Three hundred octets that unpack to ten million took as long as a thousand messages.
TEST(PacketQueue, WhatAPacketUnpacksToCounts) {
  PacketQueue queue;
  for (int i = 0; i < 3; ++i) queue.add(packet("mallory", "m", 323, 9'900'000));
  for (int i = 0; i < 100; ++i) queue.add(packet("bob", "b", 1000));
  const std::vector<std::string> topics = order(queue);
  EXPECT_EQ(std::count(topics.begin(), topics.begin() + 101, "m"), 1) << "others go before the second one";
  queue.add(packet("mallory", "m"));
  queue.add(packet("bob", "b"));
  EXPECT_EQ(order(queue).front(), "b") << "that is not forgotten when nothing waits";
}

TEST(PacketQueue, ARobotsPacketsUnpackToALimitedSize) {
  PacketQueue queue;
  std::size_t dropped = 0;
  for (int i = 0; i < 50; ++i) dropped += queue.add(packet("mallory", "m", 323, 9'900'000)).size();
  EXPECT_EQ(queue.size(), PacketQueue::kMostUnpackedOfASource / 9'900'000);
  EXPECT_EQ(queue.size() + dropped, 50u);
  EXPECT_TRUE(queue.add(packet("bob", "b", 323, 40'000'000)).empty()) << "a single one may be larger";
}

TEST(PacketQueue, WithoutRoomWhoKeepsMostLosesTheLatest) {
  PacketQueue queue;
  queue.add(packet("bob", "b"));
  for (std::size_t i = 1; i < PacketQueue::kMostPackets; ++i) queue.add(packet("mallory", std::to_string(i)));
  const std::vector<PacketReceived> dropped = queue.add(packet("bob", "b"));
  ASSERT_EQ(dropped.size(), 1u);
  EXPECT_EQ(dropped[0].source, "mallory");
  EXPECT_EQ(dropped[0].topic, std::to_string(PacketQueue::kMostPackets - 1));
  EXPECT_EQ(queue.size(), PacketQueue::kMostPackets);
  EXPECT_EQ(queue.add(packet("mallory", "m")).at(0).topic, "m");
}

TEST(PacketQueue, OctetsAreBoundedUnlessOnePacketHasMore) {
  PacketQueue queue;
  EXPECT_TRUE(queue.add(packet("bob", "b", PacketQueue::kMostOctets + 1)).empty());
  EXPECT_EQ(queue.add(packet("alice", "a", 1)).at(0).source, "alice");
  EXPECT_EQ(queue.take().topic, "b");
  queue.add(packet("alice", "a", 1));
  for (int i = 0; i < 40; ++i) queue.add(packet("mallory", "m", 1'000'000));
  EXPECT_LE(queue.octets(), PacketQueue::kMostOctets);
  EXPECT_TRUE(queue.add(packet("bob", "b", 1'500'000)).at(0).source == "mallory");
  const std::vector<std::string> topics = order(queue);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "a"), 1);
  EXPECT_EQ(std::count(topics.begin(), topics.end(), "b"), 1);
}

}  // namespace
}  // namespace adhoc_communication
