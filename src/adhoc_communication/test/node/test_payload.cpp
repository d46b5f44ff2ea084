// Payloads from the air: what is whole becomes a message, whatever else comes is refused.
#include <adhoc_communication/ExpAuction.h>
#include <adhoc_communication/ExpFrontier.h>
#include <adhoc_communication/MmControl.h>
#include <adhoc_communication/MmMapUpdate.h>
#include <adhoc_communication/RecvString.h>
#include <gtest/gtest.h>
#include <nav_msgs/OccupancyGrid.h>

#include <random>

#include "node/message_kinds.hpp"
#include "node/payload.hpp"

namespace adhoc_communication {
namespace {

PacketReceived packet(PayloadType type, Bytes payload) {
  PacketReceived received;
  received.source = "bob";
  received.topic = "topic";
  received.payload_type = static_cast<std::uint8_t>(type);
  received.payload = std::move(payload);
  return received;
}

template <typename Message>
Message parsed(const SerializedMessage& message) {
  Message result;
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(message.bytes.data()), message.bytes.size());
  ros::serialization::deserialize(stream, result);
  return result;
}

ExpAuction auction() {
  ExpAuction message;
  message.auction_id = 7;
  message.robot_name = "alice";
  message.requested_clusters.resize(2);
  message.requested_clusters[1].ids_contained.resize(3);
  message.requested_clusters[1].ids_contained[2].detected_by_robot_str = "alice";
  return message;
}

TEST(Payload, StringNamesItsTrueSender) {
  const auto message = parsed<RecvString>(decode(packet(PayloadType::kString, {'h', 'i'})));
  EXPECT_EQ(message.src_robot, "bob");
  EXPECT_EQ(message.data, "hi");
}

TEST(Payload, SenderIsOverwrittenWhereTheTypeHasOne) {
  MmControl control;
  control.src_robot = "an impostor";
  control.update_numbers = {3, 1, 2};
  const auto message = parsed<MmControl>(decode(packet(PayloadType::kControl, serialize(control))));
  EXPECT_EQ(message.src_robot, "bob");
  EXPECT_EQ(message.update_numbers, control.update_numbers);
}

TEST(Payload, OtherTypesPassBitForBit) {
  const Bytes bytes = serialize(auction());
  const auto message = decode(packet(PayloadType::kAuction, bytes));
  EXPECT_EQ(message.bytes, bytes);
  EXPECT_EQ(message.type, "adhoc_communication/ExpAuction");
}

TEST(Payload, CutAtAnyPlaceIsRefused) {
  const Bytes whole = serialize(auction());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THROW(decode(packet(PayloadType::kAuction, part)), PayloadError) << size;
  }
}

TEST(Payload, OctetsBehindTheEndAreRefused) {
  Bytes bytes = serialize(auction());
  bytes.push_back(0);
  EXPECT_THROW(decode(packet(PayloadType::kAuction, bytes)), PayloadError);
}

TEST(Payload, HugeCountIsRefusedBeforeMemoryIsTaken) {
  const Bytes four_billion_elements{0xff, 0xff, 0xff, 0xff};
  EXPECT_THROW(decode(packet(PayloadType::kFrontier, four_billion_elements)), PayloadError);
  Bytes many_small_octets(1000000, 0);
  many_small_octets[2] = 0x0f;  // claims 983040 elements of at least 52 octets
  EXPECT_THROW(decode(packet(PayloadType::kFrontier, many_small_octets)), PayloadError);
}

TEST(Payload, AlteredBytesAreDecodedOrRefusedNeverWorse) {
  std::mt19937 random(1);
  const Bytes whole = serialize(auction());
  for (int i = 0; i < 20000; ++i) {
    Bytes altered = whole;
    for (int changes = 1 + random() % 4; changes > 0; --changes) altered[random() % altered.size()] = random();
    const char types[] = "AMPpUCFcaTQRXz";
    try {
      decode(packet(static_cast<PayloadType>(types[random() % 14]), altered));
    } catch (const PayloadError&) {
    }
  }
}

TEST(Payload, MessageOfAnyTypeCarriesItsDefinitionAndYieldsWhenItIsLarge) {
  SerializedMessage sent{"std_msgs/UInt8", "7c8164229e7d2c17eb95e9231617fdee", "uint8 data\n", {42}};
  const SendRequest small = any_message_request("bob", "level", sent);
  EXPECT_EQ(small.payload_type, static_cast<std::uint8_t>(PayloadType::kAnyMessage));
  EXPECT_EQ(small.payload, encode_any_message(sent));
  EXPECT_EQ(small.priority, Priority::kNormal);
  sent.bytes.resize(50'000);
  EXPECT_EQ(any_message_request("bob", "level", sent).priority, Priority::kBulk);
  sent.md5sum = "none";
  EXPECT_THROW(any_message_request("bob", "level", sent), PayloadError);
}

}  // namespace
}  // namespace adhoc_communication
