// Numbers of 32 bits pass their greatest value.
#include <gtest/gtest.h>

#include "host.hpp"
#include "transport/hop_sender.hpp"
#include "transport/stream_sender.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using transport::HopSender;

/// The receiver takes a frame that is 64 behind for an old repetition, so none may be left open for that long.
TEST(Wrap, OldestFrameOnALinkHoldsBackTheNewest) {
  const std::uint32_t first = UINT32_MAX - 30;
  HopSender sender(first, 1000);
  std::uint64_t counter = 0;
  std::uint32_t next = first;
  const auto open = [first](std::uint32_t number) { return number == first || number == 0; };
  while (sender.may_start() && next - first < 1000) {
    sender.start({wire::FrameType::kData, {1}, 0}, ++counter, 0s);
    wire::HopAcknowledgment acknowledgment;
    acknowledgment.newest_counter = counter;
    acknowledgment.highest = next++;
    for (std::uint32_t bit = 0; bit < 64; ++bit) {
      const std::uint32_t number = acknowledgment.highest - bit;
      if (!open(number)) acknowledgment.received |= std::uint64_t{1} << bit;
    }
    sender.acknowledged(acknowledgment, 0s);
  }
  EXPECT_EQ(next - first, HopSender::kSpan);
}

TEST(Wrap, OldestLostSegmentIsRepeatedFirst) {
  transport::StreamSender sender(2, UINT32_MAX, 768);
  const auto image = std::make_shared<const Bytes>(100);
  for (SendId id = 1; id <= 3; ++id) sender.add(id, image, 100, 0s);
  sender.next_segment(0s);
  sender.next_segment(0s);
  sender.next_segment(1s);
  wire::TransportAcknowledgment acknowledgment;
  acknowledgment.source_boot = 1;
  acknowledgment.next = UINT32_MAX;
  acknowledgment.partial.push_back({1, 0, 1, {}});
  sender.acknowledged(acknowledgment, 1100ms);
  ASSERT_TRUE(sender.has_segment());
  EXPECT_EQ(sender.next_segment(1100ms).packet, UINT32_MAX);
  EXPECT_EQ(sender.next_segment(1100ms).packet, 0u);
}

/// A packet behind the wrap was passed over with those before that the root had given up.
TEST(Wrap, GroupPacketBehindItIsDelivered) {
  Stage stage;
  Host& root = stage.neighbor(1);
  stage.run_for(100ms);
  stage.node().join_group("mc_host_1", stage.now());
  stage.run_for(100ms);
  stage.say(root, wire::GroupActivation{root.address, root.boot(), 1, {stage.self().address}}, stage.self().address);
  const auto say = [&](std::uint32_t packet, std::uint32_t base) {
    const transport::Image image =
        transport::encode({transport::PacketKind::kUser, 'A', "mc_host_1", "topic", text(std::to_string(packet))});
    wire::GroupData data;
    data.root = root.address;
    data.root_boot = root.boot();
    data.packet = packet;
    data.base = base;
    data.total = static_cast<std::uint32_t>(image->size());
    data.segment_size = 1000;
    data.octets = *image;
    stage.say(root, data);
    stage.run_for(10ms);
  };
  say(UINT32_MAX - 1, UINT32_MAX - 1);
  say(1, UINT32_MAX - 1);
  say(2, 2);
  std::vector<std::string> received;
  for (const auto& item : stage.team.received(0)) {
    received.emplace_back(item.packet.payload.begin(), item.packet.payload.end());
  }
  EXPECT_EQ(received, (std::vector<std::string>{std::to_string(UINT32_MAX - 1), "1", "2"}));
}

}  // namespace
}  // namespace adhoc_communication
