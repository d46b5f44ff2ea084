// Frames: what is written is read back; what is cut short, altered or unknown is refused.
#include <gtest/gtest.h>

#include "payloads.hpp"
#include "random.hpp"
#include "simulation/team.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::wire {
namespace {

const MacAddress kA = {2, 0, 0, 0, 0, 1};
const MacAddress kB = {2, 0, 0, 0, 0, 2};

RouteRequest request() {
  RouteRequest request;
  request.gratuitous = true;
  request.hop_count = 3;
  request.hop_limit = 9;
  request.cost = 0x0110;
  request.id = 0x01020304;
  request.destination = kB;
  request.destination_sequence = 0x05060708;
  request.destination_name = "robot_2";
  request.originator = kA;
  request.originator_sequence = 0x090a0b0c;
  request.originator_boot = 0x1112131415161718;
  request.originator_name = "robot_1";
  return request;
}

template <typename Message, typename Read>
void refuses_every_prefix(const Message& message, Read read) {
  const Bytes bytes = to_bytes(message);
  ASSERT_TRUE(read(Reader(bytes)));
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(read(Reader(bytes.data(), size))) << size;
}

TEST(Wire, A1_1_A1_2_RequestIsInNetworkByteOrder) {
  const Bytes bytes = to_bytes(request());
  const Bytes expected = {0x20, 3,    9,    1,    0x10, 1,    2,    3,    4,    2,   0,   0,   0,   0,
                          2,    5,    6,    7,    8,    2,    0,    0,    0,    0,   1,   9,   10,  11,
                          12,   0x11, 0x12, 0x13, 0x14, 0x15, 0x16, 0x17, 0x18, 7,   'r', 'o', 'b', 'o',
                          't',  '_',  '2',  7,    'r',  'o',  'b',  'o',  't',  '_', '1'};
  EXPECT_EQ(bytes, expected);
  EXPECT_EQ(to_bytes(*read_route_request(Reader(bytes))), bytes);
}

TEST(Wire, A1_3_ReplyRoundTrip) {
  const RouteReply reply{false, true, 2, 0x0110, kB, 0x01020304, 77, "robot_2", kA, 6000};
  const Bytes bytes = to_bytes(reply);
  EXPECT_EQ(to_bytes(*read_route_reply(Reader(bytes))), bytes);
  refuses_every_prefix(reply, read_route_reply);
}

TEST(Wire, A1_4_ErrorNeedsItsDestinations) {
  RouteError error;
  EXPECT_FALSE(read_route_error(Reader(to_bytes(error))));
  error.destinations = {{kA, 1}, {kB, 2}};
  refuses_every_prefix(error, read_route_error);
  Bytes bytes = to_bytes(error);
  bytes[1] = 3;
  EXPECT_FALSE(read_route_error(Reader(bytes)));
}

TEST(Wire, A1_7_ExtensionsAreSkippedOrRefused) {
  const Bytes plain = to_bytes(request());
  const auto with = [&](std::initializer_list<std::uint8_t> extension) {
    Bytes bytes = plain;
    bytes.insert(bytes.end(), extension);
    return read_route_request(Reader(bytes)).has_value();
  };
  EXPECT_TRUE(with({100, 4, 1, 2, 3, 4}));
  EXPECT_FALSE(with({200, 4, 1, 2, 3, 4}));
  EXPECT_FALSE(with({100, 5, 1, 2, 3, 4}));
}

TEST(Wire, TruncatedMessagesAreRefused) {
  refuses_every_prefix(request(), read_route_request);
  refuses_every_prefix(HopAcknowledgment{1, 2, 3, 4, 5, 6}, read_hop_acknowledgment);
  Beacon beacon{1, 2, 3, "robot_1", 4, {{5, 6}}, {{kB, 6, 7, 2, "robot_2"}}, 0};
  const Bytes bytes = to_bytes(beacon);
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(read_beacon(Reader(bytes.data(), size))) << size;
  TransportAcknowledgment acknowledgment{kA, 1, kB, 2, 3, 1, 9, {{9, 1, 4, {0x0f, 0x80}}}, {{10, 3}}};
  refuses_every_prefix(acknowledgment, read_transport_acknowledgment);
}

TEST(Wire, NobodyHasTheNullAddressOrAGroups) {
  const MacAddress group = {3, 0, 0, 0, 0, 1};
  for (const MacAddress& nobody : {MacAddress{}, kEverybody, group}) {
    RouteRequest asked = request();
    asked.originator = nobody;
    EXPECT_FALSE(read_route_request(Reader(to_bytes(asked))));
    const RouteReply about{false, true, 2, 0x0110, nobody, 1, 77, "robot_2", kA, 6000};
    EXPECT_FALSE(read_route_reply(Reader(to_bytes(about))));
    const RouteReply to{false, true, 2, 0x0110, kB, 1, 77, "robot_2", nobody, 6000};
    EXPECT_FALSE(read_route_reply(Reader(to_bytes(to))));
    RouteError error;
    error.destinations = {{kA, 1}, {nobody, 2}};
    EXPECT_FALSE(read_route_error(Reader(to_bytes(error))));
    const Beacon beacon{1, 2, 3, "robot_1", 4, {{5, 6}}, {{nobody, 6, 7, 2, "robot_2"}}, 0};
    EXPECT_FALSE(read_beacon(Reader(to_bytes(beacon))));
  }
}

TEST(Wire, SegmentMustHaveTheLengthItsPlaceDemands) {
  Data data;
  data.source = kA;
  data.destination = kB;
  data.total = 250;
  data.segment_size = 100;
  data.index = 2;
  data.octets = Bytes(50);
  EXPECT_TRUE(read_data(Reader(to_bytes(data))));
  data.octets = Bytes(51);
  EXPECT_FALSE(read_data(Reader(to_bytes(data))));
  data.index = 3;
  EXPECT_FALSE(read_data(Reader(to_bytes(data))));
}

TEST(Wire, HeaderRefusesOtherVersionsTypesAndFlags) {
  FrameHeader header;
  header.type = FrameType::kData;
  header.sender = kA;
  Bytes bytes;
  Writer writer(bytes);
  write(writer, header);
  ASSERT_EQ(bytes.size(), kHeaderSize);
  const auto readable = [](Bytes changed, std::size_t at, std::uint8_t value) {
    changed[at] = value;
    Reader reader(changed);
    return read_header(reader).has_value();
  };
  EXPECT_TRUE(readable(bytes, 0, kVersion));
  EXPECT_FALSE(readable(bytes, 0, kVersion + 1));
  EXPECT_FALSE(readable(bytes, 1, 0));
  EXPECT_FALSE(readable(bytes, 1, 16));
  EXPECT_FALSE(readable(bytes, 2, 0x80));
}

TEST(Wire, A1_9_ChecksumFindsEveryAlteredOctet) {
  const Bytes frame = close_openly({}, text("body"));
  ASSERT_TRUE(open_body(frame));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    Bytes altered = frame;
    altered[i] ^= 0x40;
    EXPECT_FALSE(open_body(altered)) << i;
  }
}

}  // namespace
}  // namespace adhoc_communication::wire
