// The map whose busy entries are looked at alone.
#include <gtest/gtest.h>

#include "busy_map.hpp"

namespace adhoc_communication {
namespace {

TEST(BusyMap, OnlyEntriesInUseAreBusyUntilTheySettle) {
  BusyMap<int, int> map;
  for (const int key : {3, 1, 2}) map.use(key, [key] { return 10 * key; });
  map.settle([](int value) { return value != 20; });
  ASSERT_EQ(map.busy().size(), 1u);
  EXPECT_TRUE(map.is_busy(2));
  EXPECT_EQ(map.size(), 3u);
  ++map.use(1, [] { return 0; });
  EXPECT_EQ(*map.find(1), 11) << "made only once";
  EXPECT_EQ(map.busy().begin()->first, 1) << "in the order of the keys";
}

TEST(BusyMap, WhatIsErasedIsNotBusy) {
  BusyMap<int, int> map;
  for (const int key : {1, 2, 3}) map.use(key, [] { return 0; });
  map.erase(2);
  EXPECT_EQ(map.find(2), nullptr);
  EXPECT_FALSE(map.is_busy(2));
  map.erase_if([](int key, int) { return key == 3; });
  EXPECT_EQ(map.size(), 1u);
  EXPECT_EQ(map.busy().size(), 1u);
}

}  // namespace
}  // namespace adhoc_communication
