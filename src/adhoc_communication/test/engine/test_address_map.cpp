// The table that is looked into for every frame.
#include <gtest/gtest.h>

#include <map>

#include "address_map.hpp"
#include "random.hpp"

namespace adhoc_communication {
namespace {

MacAddress some_address(Random& random) {
  return {{0x02, 0, 0, 0, static_cast<std::uint8_t>(random.next() % 3), static_cast<std::uint8_t>(random.next() % 20)}};
}

TEST(AddressMap, DoesWhatAMapDoes) {
  Random random(1);
  std::map<MacAddress, int> expected;
  AddressMap<int> map;
  for (int step = 0; step < 5000; ++step) {
    const MacAddress address = some_address(random);
    switch (random.next() % 4) {
      case 0:
        EXPECT_EQ(map.emplace(address, step).second, expected.emplace(address, step).second);
        break;
      case 1:
        map[address] += step;
        expected[address] += step;
        break;
      case 2:
        map.erase(address);
        expected.erase(address);
        break;
      default:
        const auto found = map.upper_bound(address);
        const auto there = expected.upper_bound(address);
        ASSERT_EQ(found == map.end(), there == expected.end());
        if (found != map.end()) EXPECT_EQ(found->first, there->first);
    }
    ASSERT_EQ(map.count(address), expected.count(address));
    ASSERT_TRUE(std::equal(map.begin(), map.end(), expected.begin(), expected.end()));
  }
}

TEST(AddressMap, EntriesStayWhereTheyAre) {
  AddressMap<int> map;
  const MacAddress kept{{0x02, 0, 0, 0, 0, 100}};
  const int* entry = &map[kept];
  for (std::uint8_t i = 0; i < 200; ++i) map[{{0x02, 0, 0, 0, 0, i}}] = i;
  for (auto item = map.begin(); item != map.end();) item = item->first == kept ? std::next(item) : map.erase(item);
  EXPECT_EQ(&map.at(kept), entry);
  EXPECT_EQ(*entry, 100);
  EXPECT_EQ(map.size(), 1u);
  EXPECT_THROW(map.at(MacAddress{}), std::out_of_range);
}

}  // namespace
}  // namespace adhoc_communication
