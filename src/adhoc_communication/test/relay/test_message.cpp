// Messages of any type as packets carry them.
#include <gtest/gtest.h>

#include "relay/message.hpp"

namespace adhoc_communication {
namespace {

PacketReceived packet(PayloadType type, Bytes payload) {
  PacketReceived received;
  received.payload_type = static_cast<std::uint8_t>(type);
  received.payload = std::move(payload);
  return received;
}

TEST(Message, AnyMessageKeepsTypeDefinitionAndBytes) {
  const SerializedMessage sent{"std_msgs/UInt8", "7c8164229e7d2c17eb95e9231617fdee", "uint8 data\n", {42}};
  const auto received = decode_any_message(packet(PayloadType::kAnyMessage, encode_any_message(sent)));
  EXPECT_EQ(received.type, sent.type);
  EXPECT_EQ(received.md5sum, sent.md5sum);
  EXPECT_EQ(received.definition, sent.definition);
  EXPECT_EQ(received.bytes, sent.bytes);
}

TEST(Message, MessageWithoutDefinitionKeepsTypeAndBytes) {
  const SerializedMessage sent{"std_msgs/UInt8", "7c8164229e7d2c17eb95e9231617fdee", "uint8 data\n", {42}};
  const Bytes payload = encode_message_by_type(sent);
  EXPECT_LT(payload.size(), encode_any_message(sent).size());
  const auto received = decode_any_message(packet(PayloadType::kMessageByType, payload));
  EXPECT_EQ(received.type, sent.type);
  EXPECT_EQ(received.md5sum, sent.md5sum);
  EXPECT_EQ(received.definition, "");
  EXPECT_EQ(received.bytes, sent.bytes);
  for (std::size_t size = 0; size < payload.size() - sent.bytes.size(); ++size) {
    const Bytes cut(payload.begin(), payload.begin() + static_cast<long>(size));
    EXPECT_THROW(decode_any_message(packet(PayloadType::kMessageByType, cut)), PayloadError) << size;
  }
}

TEST(Message, TypeAndChecksumHaveToLookLikeSuch) {
  const std::string md5sum = "7c8164229e7d2c17eb95e9231617fdee";
  EXPECT_NO_THROW(check_type("std_msgs/UInt8", md5sum));
  for (const char* type : {"", "UInt8", "std_msgs/", "/UInt8", "std_msgs/UInt8/x", "std msgs/UInt8", "*"}) {
    EXPECT_THROW(check_type(type, md5sum), PayloadError) << type;
  }
  for (const char* text : {"", "*", "7c8164229e7d2c17eb95e9231617fde", "7C8164229E7D2C17EB95E9231617FDEE"}) {
    EXPECT_THROW(check_type("std_msgs/UInt8", text), PayloadError) << text;
  }
}

TEST(Message, TextsAreThoseOfRosSerialisation) {
  const Bytes octets = encode_message_by_type({"a/B", "c", {}, {7}, false});
  EXPECT_EQ(octets, (Bytes{3, 0, 0, 0, 'a', '/', 'B', 1, 0, 0, 0, 'c', 7}));
}

TEST(Message, ALengthBeyondTheEndIsRefusedBeforeMemoryIsTaken) {
  EXPECT_THROW(decode_any_message(packet(PayloadType::kAnyMessage, {0xff, 0xff, 0xff, 0xff, 'a'})), PayloadError);
}

TEST(Message, FourPayloadsNameTheirType) {
  for (const char type : {'X', 'x', 'D', 'd'}) {
    EXPECT_TRUE(names_its_type(packet(static_cast<PayloadType>(type), {}))) << type;
  }
  for (const char type : {'A', 'M', 'z'}) {
    EXPECT_FALSE(names_its_type(packet(static_cast<PayloadType>(type), {}))) << type;
  }
}

}  // namespace
}  // namespace adhoc_communication
