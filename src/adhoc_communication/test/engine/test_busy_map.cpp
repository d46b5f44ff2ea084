// The map whose busy entries are looked at alone.
#include <gtest/gtest.h>

#include "busy_map.hpp"

namespace adhoc_communication {
namespace {

MacAddress address(int number) { return {{0x02, 0, 0, 0, 0, static_cast<std::uint8_t>(number)}}; }

TEST(BusyMap, OnlyEntriesInUseAreBusyUntilTheySettle) {
  BusyMap<int> map;
  for (const int number : {3, 1, 2}) map.use(address(number), [number] { return 10 * number; });
  map.settle([](int value) { return value != 20; });
  ASSERT_EQ(map.busy().size(), 1u);
  EXPECT_TRUE(map.is_busy(address(2)));
  EXPECT_EQ(map.size(), 3u);
  ++map.use(address(1), [] { return 0; });
  EXPECT_EQ(*map.find(address(1)), 11) << "made only once";
  EXPECT_EQ(map.busy().begin()->first, address(1)) << "in the order of the addresses";
}

TEST(BusyMap, WhatIsErasedIsNotBusy) {
  BusyMap<int> map;
  for (const int number : {1, 2, 3}) map.use(address(number), [] { return 0; });
  map.erase(address(2));
  EXPECT_EQ(map.find(address(2)), nullptr);
  EXPECT_FALSE(map.is_busy(address(2)));
  map.erase_if([](const MacAddress& known, int) { return known == address(3); });
  EXPECT_EQ(map.size(), 1u);
  EXPECT_EQ(map.busy().size(), 1u);
}

}  // namespace
}  // namespace adhoc_communication
