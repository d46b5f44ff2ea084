// What a receipt says of a packet.
#pragma once

#include "multicast/transfer.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::multicast {

enum class Had { kNot, kWaits, kDelivered };

inline Had had(const wire::GroupReceipt& receipt, std::uint32_t number) {
  if (before(number, receipt.next)) return Had::kDelivered;
  const std::uint32_t ahead = number - receipt.next - 1;
  return ahead < 32 && (receipt.beyond >> ahead & 1) != 0 ? Had::kWaits : Had::kNot;
}

}  // namespace adhoc_communication::multicast
