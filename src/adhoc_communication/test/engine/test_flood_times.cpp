// When a member is late to say that it has a flooded packet.
#include <gtest/gtest.h>

#include "multicast/flood_times.hpp"

namespace adhoc_communication::multicast {
namespace {

using namespace std::chrono_literals;

constexpr MacAddress kMember{2, 0, 0, 0, 0, 1};
constexpr MacAddress kOther{2, 0, 0, 0, 0, 2};
constexpr std::uint8_t kStream = 2;

wire::GroupReceipt receipt(const MacAddress& member, std::uint32_t next, std::uint8_t stream = kStream) {
  wire::GroupReceipt receipt;
  receipt.member = member;
  receipt.stream = stream;
  receipt.next = next;
  return receipt;
}

TEST(FloodTimes, WhatIsSaidAfterItWasGivenUpCounts) {
  FloodTimes times;
  for (int i = 0; i < 20; ++i) times.sample(50ms);
  EXPECT_EQ(times.timeout(), 200ms);
  times.given_up(kMember, {kStream, 7}, 10s);
  times.told(receipt(kMember, 8), 11s);
  EXPECT_GT(times.timeout(), 1s);
  const Time timeout = times.timeout();
  times.told(receipt(kMember, 8), 11s);
  EXPECT_EQ(times.timeout(), timeout) << "it is said once";
}

/// What ninety-nine say at once had made it forget the last one by the next packet.
TEST(FloodTimes, OfManyMembersTheSlowestCounts) {
  FloodTimes times;
  for (int packet = 0; packet < 20; ++packet) {
    times.sample(2s);
    for (int i = 0; i < 99; ++i) times.sample(100ms);
  }
  EXPECT_GT(times.timeout(), 2s);
  for (int i = 0; i < 5000; ++i) times.sample(100ms);
  EXPECT_LT(times.timeout(), 250ms) << "it is not there any more";
}

TEST(FloodTimes, OnlyOfThatMemberAndThatPacketAndNotLongAfter) {
  FloodTimes times;
  times.given_up(kMember, {kStream, 7}, 10s);
  times.told(receipt(kOther, 8), 11s);
  times.told(receipt(kMember, 7), 11s);
  times.told(receipt(kMember, 8, 3), 11s);
  times.told(receipt(kMember, 8), 10s + FloodTimes::kLongest + 1ms);
  EXPECT_EQ(times.timeout(), FloodTimes().timeout());
}

/// Each loss made the timeout longer, until the next one was waited for as long as can be.
TEST(FloodTimes, WhatIsSaidOfACopyDoesNotCount) {
  FloodTimes times;
  for (int i = 0; i < 20; ++i) times.sample(50ms);
  times.given_up(kMember, {kStream, 7}, 10s);
  times.given_up(kMember, {kStream, 8}, 10s);
  times.copied(kMember, {kStream, 7});
  times.told(receipt(kMember, 8), 11s);
  EXPECT_EQ(times.timeout(), 200ms);
  times.told(receipt(kMember, 9), 11s);
  EXPECT_GT(times.timeout(), 1s) << "the other one was not copied";
}

TEST(FloodTimes, TheOldestMakeRoom) {
  FloodTimes times;
  times.given_up(kMember, {kStream, 7}, 10s);
  for (std::uint32_t i = 0; i < FloodTimes::kMostGivenUp; ++i) times.given_up(kOther, {kStream, 100 + i}, 10s);
  times.told(receipt(kMember, 8), 11s);
  EXPECT_EQ(times.timeout(), FloodTimes().timeout());
  times.told(receipt(kOther, 101), 11s);
  EXPECT_NE(times.timeout(), FloodTimes().timeout());
}

}  // namespace
}  // namespace adhoc_communication::multicast
