// The engine carries payloads as hosts have packed them, and unpacks nothing.
#include <gtest/gtest.h>

#include "adhoc_communication/compression.hpp"
#include "host.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

TEST(Compression, TheEngineNeitherPacksNorUnpacks) {
  Team team;
  team.add_line(2, without_groups());
  team.run_for(1s);
  const Bytes zeros(100'000);
  SendRequest request{"robot_1", "topic", 'A', zeros, Priority::kNormal};
  const auto sent_octets = [&](const SendRequest& sent) {
    const std::uint64_t before = team.engine(0).statistics().bytes_sent;
    const SendId id = team.engine(0).send(sent, team.now());
    team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 5s);
    return team.engine(0).statistics().bytes_sent - before;
  };
  EXPECT_GT(sent_octets(request), zeros.size()) << "who packs is the host";
  pack(request);
  EXPECT_EQ(request.unpacked_size, zeros.size());
  EXPECT_LT(request.payload.size(), 1000u);
  bool packed = false;
  team.on_event = [&](std::size_t, const Event& event) {
    if (const auto* packet = std::get_if<PacketReceived>(&event)) packed = packet->payload == zeros;
  };
  EXPECT_LT(sent_octets(request), 2000u);
  EXPECT_TRUE(packed) << "the team unpacks what its engines report";
}

TEST(Compression, EventsStayPackedUntilTheHostUnpacksThem) {
  Stage stage;
  Host& host = stage.neighbor(1);
  stage.run_for(10ms);
  const Bytes zeros(50'000);
  const transport::Image image = transport::encode({transport::PacketKind::kUser, 'A', {}, "topic", zeros});
  wire::Data data = data_for(stage.self(), host);
  data.total = static_cast<std::uint32_t>(image->size());
  data.octets = *image;
  stage.say(host, data);
  std::optional<PacketReceived> received;
  while (auto event = stage.node().next_event()) {
    if (auto* packet = std::get_if<PacketReceived>(&*event)) received = std::move(*packet);
  }
  ASSERT_TRUE(received);
  EXPECT_EQ(received->unpacked_size, zeros.size());
  EXPECT_LT(received->payload.size(), 1000u);
  ASSERT_TRUE(unpack(*received));
  EXPECT_EQ(received->payload, zeros);
  EXPECT_TRUE(unpack(*received)) << "once is enough";
  EXPECT_EQ(received->payload, zeros);
}

/// Reported as sent, and dropped as malformed by whoever heard them.
TEST(Compression, LargeMapsForEverybodyInReachArrive) {
  Team team;
  for (int robot = 0; robot < 3; ++robot) team.add();
  team.run_for(2s);
  for (const std::size_t size : {std::size_t{100'000}, std::size_t{200'000}, std::size_t{1'000'000}}) {
    for (const Bytes& map : {map_like(size), Bytes(size, 0xff)}) {
      for (std::size_t robot = 1; robot < 3; ++robot) team.received(robot).clear();
      SendRequest request{"", "map", 'M', map, Priority::kBulk};
      pack(request);
      EXPECT_GT(request.unpacked_size, 64'000u);
      const SendId id = team.send(0, std::move(request));
      ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 10s));
      team.run_for(1s);
      EXPECT_TRUE(team.finished(0, id)->delivered);
      for (std::size_t robot = 1; robot < 3; ++robot) {
        ASSERT_EQ(team.received(robot).size(), 1u) << size;
        EXPECT_TRUE(team.received(robot)[0].packet.payload == map) << size;
      }
    }
  }
  EXPECT_EQ(team.engine(1).statistics().frames_dropped.malformed, 0u);
}

TEST(Compression, AFloodThatNobodyWouldUnpackIsRefused) {
  Team team;
  for (int robot = 0; robot < 2; ++robot) team.add();
  team.run_for(2s);
  for (const std::size_t size : {std::size_t{64'000}, std::size_t{64'001}}) {
    BroadcastRequest request;
    request.topic = "topic";
    request.payload_type = 'A';
    request.payload = Bytes(size);
    pack(request);
    const SendId id = team.broadcast(0, std::move(request));
    team.run_for(1s);
    ASSERT_NE(team.finished(0, id), nullptr);
    EXPECT_EQ(team.finished(0, id)->delivered, size == 64'000) << team.finished(0, id)->reason;
  }
  EXPECT_EQ(team.received(1).size(), 1u);
}

TEST(Compression, WhatDoesNotUnpackIsOfNoUse) {
  SendRequest request{"robot_1", "topic", 'A', Bytes(10'000), Priority::kNormal};
  pack(request);
  PacketReceived packet;
  packet.payload = request.payload;
  packet.payload[packet.payload.size() / 2] ^= 0x55;
  packet.unpacked_size = request.unpacked_size;
  const Bytes before = packet.payload;
  EXPECT_FALSE(unpack(packet));
  EXPECT_EQ(packet.payload, before);
  packet.payload = request.payload;
  ++packet.unpacked_size;
  EXPECT_FALSE(unpack(packet));
}

TEST(Compression, ShortAndRandomPayloadsStayAsTheyAre) {
  for (const Bytes& payload : {Bytes(50), noise(10'000)}) {
    SendRequest request{"robot_1", "topic", 'A', payload, Priority::kNormal};
    pack(request);
    EXPECT_EQ(request.unpacked_size, 0u);
    EXPECT_EQ(request.payload, payload);
  }
}

}  // namespace
}  // namespace adhoc_communication
