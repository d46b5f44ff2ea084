// What slow subscribers keep, and what they lose.
#include <gtest/gtest.h>

#include "relay/subscriber_queue.hpp"

namespace adhoc_communication {
namespace {

SubscriberQueue::Message message(std::size_t octets) { return std::make_shared<const Bytes>(octets); }

TEST(SubscriberQueues, WhoTakesEverythingGetsEverythingAtOnce) {
  SubscriberQueue queue;
  for (std::size_t i = 1; i <= 300; ++i) {
    EXPECT_EQ(queue.add(message(i)), 0u);
    EXPECT_EQ(queue.next({})->size(), i);
  }
  EXPECT_TRUE(queue.empty());
  EXPECT_EQ(queue.next({}), nullptr);
}

TEST(SubscriberQueues, WhoTakesNothingLosesTheOldestBeyondTheNumber) {
  SubscriberQueue queue;
  std::size_t dropped = 0;
  for (std::size_t i = 1; i <= 130; ++i) dropped += queue.add(message(i));
  EXPECT_EQ(dropped, 30u);
  EXPECT_EQ(queue.next({})->size(), 31u);
}

TEST(SubscriberQueues, WhoTakesNothingLosesTheOldestBeyondTheOctets) {
  SubscriberQueue queue;
  std::size_t dropped = 0;
  for (std::size_t i = 0; i < 20; ++i) dropped += queue.add(message(1'000'000 + i));
  EXPECT_EQ(dropped, 13u);
  EXPECT_LE(queue.octets(), SubscriberQueue::kMostOctets);
  EXPECT_EQ(queue.next({})->size(), 1'000'013u);
  EXPECT_EQ(queue.add(message(20'000'000)), 6u) << "a single one may be larger";
  EXPECT_EQ(queue.next({})->size(), 20'000'000u);
  EXPECT_EQ(queue.octets(), 0u);
}

TEST(SubscriberQueues, LittleIsHandedToWhoHasNotTakenWhatHeWasHanded) {
  SubscriberQueue queue;
  queue.add(message(600'000));
  EXPECT_EQ(queue.next({1, 600'000}), nullptr);
  EXPECT_EQ(queue.next({SubscriberQueue::kMostMessagesInHand, 1000}), nullptr);
  EXPECT_NE(queue.next({1, 400'000}), nullptr);
  queue.add(message(3'000'000));
  EXPECT_NE(queue.next({0, 0}), nullptr);
}

}  // namespace
}  // namespace adhoc_communication
