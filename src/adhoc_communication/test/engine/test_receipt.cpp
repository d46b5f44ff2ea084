// What a receipt says of packets.
#include <gtest/gtest.h>

#include "multicast/receipt.hpp"

namespace adhoc_communication::multicast {
namespace {

wire::GroupReceipt receipt(std::uint32_t next, std::uint32_t beyond) {
  wire::GroupReceipt receipt;
  receipt.next = next;
  receipt.beyond = beyond;
  return receipt;
}

/// As a member does that gets the packets one by one.
wire::GroupReceipt counted(std::uint32_t next, std::uint32_t beyond, std::uint32_t delivered) {
  std::uint32_t now = delivered + 1;
  while (had(receipt(next, beyond), now) == Had::kWaits) ++now;
  std::uint32_t rest = 0;
  for (std::uint32_t i = 0; i < 32; ++i) {
    if (had(receipt(next, beyond), now + 1 + i) == Had::kWaits) rest |= std::uint32_t{1} << i;
  }
  return receipt(now, rest);
}

TEST(Receipt, WithOneMorePacketDeliveredTheOthersAreWhereTheyWere) {
  for (const std::uint32_t next : {5u, 0xfffffff0u}) {
    for (std::uint32_t beyond = 0; beyond < 256; ++beyond) {
      for (std::uint32_t ahead = 0; ahead < 40; ++ahead) {
        const wire::GroupReceipt found = with_delivered(receipt(next, beyond), next + ahead);
        const wire::GroupReceipt right = counted(next, beyond, next + ahead);
        ASSERT_EQ(found.next, right.next) << beyond << ' ' << ahead;
        ASSERT_EQ(found.beyond, right.beyond) << beyond << ' ' << ahead;
      }
    }
  }
  EXPECT_EQ(with_delivered(receipt(5, 0xffffffff), 5).next, 38u);
}

}  // namespace
}  // namespace adhoc_communication::multicast
