// Packets as they were put together from segments: any octets.
#include <cstdint>
#include <cstdlib>

#include "transport/packet_image.hpp"

namespace {

constexpr std::size_t kLargest = 100'000;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace transport = adhoc_communication::transport;
  const auto packet = transport::decode(adhoc_communication::Bytes(data, data + size), kLargest);
  if (!packet) return 0;
  if (packet->payload.size() > kLargest) std::abort();
  const auto again = transport::decode(*transport::encode(*packet), kLargest);
  if (!again || again->kind != packet->kind || again->payload_type != packet->payload_type ||
      again->group != packet->group || again->topic != packet->topic || again->payload != packet->payload) {
    std::abort();
  }
  return 0;
}
