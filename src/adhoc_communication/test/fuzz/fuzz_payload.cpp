// Messages of the contract in packets of others. The first octet is the payload type, the others are the payload.
#include <cstdint>
#include <cstdlib>

#include "node/payload.hpp"

namespace adhoc_communication {
namespace {

/// What is published is a message of its type: it is read as what it was written from.
void check(PacketReceived packet) {
  try {
    const SerializedMessage message = decode(packet);
    if (names_its_type(packet)) return;
    if (message.type.empty() || message.md5sum.size() != 32 || message.definition.empty()) std::abort();
    if (packet.payload_type == static_cast<std::uint8_t>(PayloadType::kString)) {
      if (message.bytes.size() != 8 + packet.source.size() + packet.payload.size()) std::abort();
      return;
    }
    packet.payload = message.bytes;
    if (decode(packet).bytes != message.bytes) std::abort();
  } catch (const PayloadError&) {
  }
}

}  // namespace
}  // namespace adhoc_communication

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  adhoc_communication::PacketReceived packet;
  packet.source = "robot_1";
  packet.payload_type = data[0];
  packet.payload.assign(data + 1, data + size);
  adhoc_communication::check(std::move(packet));
  return 0;
}
