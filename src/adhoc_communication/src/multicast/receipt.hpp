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

/// The same once that packet is delivered as well, and what waited for it.
inline wire::GroupReceipt with_delivered(wire::GroupReceipt receipt, std::uint32_t number) {
  const std::uint32_t steps = number - receipt.next;
  receipt.beyond = steps < 32 ? receipt.beyond >> steps : 0;
  receipt.next = number + 1;
  while ((receipt.beyond & 1) != 0) {
    receipt.beyond >>= 1;
    ++receipt.next;
  }
  receipt.beyond >>= 1;
  return receipt;
}

}  // namespace adhoc_communication::multicast
