// Messages of any type in packets of others, and their definitions, whose sums are computed. The first octet selects
// the payload type, or the reader of definitions; the others are the payload, or a type, a line break and a definition.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "relay/definition_md5.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {
namespace {

constexpr PayloadType kTypes[] = {PayloadType::kAnyMessage, PayloadType::kMessageByType, PayloadType::kDefinition,
                                  PayloadType::kDefinitionRequest};

/// There is one payload of each message.
void check_message(PayloadType type, const Bytes& payload) {
  PacketReceived packet;
  packet.payload_type = static_cast<std::uint8_t>(type);
  packet.payload = payload;
  if (!names_its_type(packet)) std::abort();
  try {
    const SerializedMessage message = decode_any_message(packet);
    const bool with_definition = type == PayloadType::kAnyMessage || type == PayloadType::kDefinition;
    if ((with_definition ? encode_any_message(message) : encode_message_by_type(message)) != payload) std::abort();
  } catch (const PayloadError&) {
  }
}

void check_definition(const std::string& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string type = text.substr(0, end);
  const std::string definition = text.substr(std::min(end + 1, text.size()));
  try {
    const std::string sum = md5_of_definition(type, definition);
    if (sum.size() != 32 || sum.find_first_not_of("0123456789abcdef") != std::string::npos) std::abort();
    if (md5_of_definition(type, definition) != sum) std::abort();
  } catch (const PayloadError&) {
  }
}

}  // namespace
}  // namespace adhoc_communication

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace adhoc_communication;
  if (size == 0) return 0;
  const std::size_t reader = data[0] % 5;
  if (reader == 4) {
    check_definition(std::string(data + 1, data + size));
  } else {
    check_message(kTypes[reader], Bytes(data + 1, data + size));
  }
  return 0;
}
