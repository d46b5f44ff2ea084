// Group packets for which there is no room, at the robot that lacks it and at the one above it in the tree.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "multicast/distribution.hpp"
#include "multicast/groups.hpp"
#include "multicast/sink.hpp"
#include "multicast/tree.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kLargestForGroup = 100'000;

EngineOptions small() {
  EngineOptions options;
  options.max_packet_size = kLargestForGroup;
  return options;
}

/// Packets of the largest size that never end but go on all the time.
class Hoarders {
 public:
  explicit Hoarders(Stage& stage) : stage_(stage) {}
  void go_on() {
    for (std::size_t number = 11; number <= 14; ++number) {
      Host& host = stage_.neighbor(number);
      wire::Data data = data_for(stage_.self(), host);
      data.total = kLargestForGroup;
      data.segment_size = 1400;
      data.index = index_;
      data.octets.assign(1400, 0);
      stage_.say(host, data);
    }
    ++index_;
  }

 private:
  Stage& stage_;
  std::uint32_t index_ = 0;
};

TEST(GroupRoom, WantOfItIsTold) {
  Stage stage(small());
  Host& root = stage.neighbor(1);
  stage.run_for(100ms);
  stage.node().join_group("mc_host_1", stage.now());
  stage.say(root, wire::GroupActivation{root.address, root.boot(), 1, {stage.self().address}}, stage.self().address);
  Hoarders hoarders(stage);
  hoarders.go_on();
  stage.run_for(10ms);
  stage.forget();
  wire::GroupData data;
  data.root = root.address;
  data.root_boot = root.boot();
  data.total = kLargestForGroup;
  data.segment_size = 1400;
  data.report = true;
  data.round = 7;
  data.octets = noise(1400);
  for (int i = 0; i < 40; ++i) {
    stage.say(root, data);
    if (i % 10 == 0) hoarders.go_on();
    stage.run_for(10ms);
  }
  const auto reports = stage.sent<wire::GroupReport>();
  ASSERT_FALSE(reports.empty());
  EXPECT_LE(reports.size(), 9u) << "once in 50 ms is enough";
  for (const auto& [at, to, report] : reports) {
    EXPECT_EQ(to, root.address);
    EXPECT_EQ(report.first_block, wire::kNoRoom);
    EXPECT_EQ(report.round, 7u);
    EXPECT_FALSE(report.complete);
  }
  stage.forget();
  stage.run_for(3s);
  stage.say(root, data);
  stage.run_for(10ms);
  ASSERT_FALSE(stage.sent<wire::GroupReport>().empty());
  EXPECT_EQ(stage.sent<wire::GroupReport>().back().message.first_block, 0u) << "the others have stalled";
}

/// The node is the root, the host its only member, which has no room for 20 s.
TEST(GroupRoom, IsWaitedForWithoutAFrame) {
  Stage stage(small());
  Host& member = stage.neighbor(1);
  stage.run_for(100ms);
  wire::Data join = data_for(stage.self(), member);
  join.stream = 0;
  join.octets = *transport::encode({transport::PacketKind::kGroupJoin, 0, "mc_robot_0", {}, {}});
  join.total = static_cast<std::uint32_t>(join.octets.size());
  stage.say(member, join, stage.self().address);
  stage.run_for(100ms);
  const SendId id = stage.team.send(0, "mc_robot_0", noise(50'000));
  stage.run_for(10ms);
  const auto answer = [&](std::uint16_t first_block, const Bytes& missing, bool complete) {
    const auto frames = stage.sent<wire::GroupData>();
    if (frames.empty()) return;
    const wire::GroupData& asked = frames.back().message;
    wire::GroupReport report;
    report.root = asked.root;
    report.root_boot = asked.root_boot;
    report.stream = asked.stream;
    report.packet = asked.packet;
    report.epoch = 1;
    report.round = asked.round;
    report.coverage = multicast::digest(member.address);
    report.first_block = first_block;
    report.missing = missing;
    report.complete = complete;
    stage.say(member, report, stage.self().address);
  };
  const auto symbols = [&] {
    const auto frames = stage.sent<wire::GroupData>();
    return std::count_if(frames.begin(), frames.end(), [](const auto& frame) { return !frame.message.octets.empty(); });
  };
  answer(wire::kNoRoom, {}, false);
  stage.run_for(50ms);
  stage.forget();
  for (int i = 0; i < 100; ++i) {
    stage.run_for(200ms);
    answer(wire::kNoRoom, {}, false);
  }
  EXPECT_EQ(symbols(), 0);
  EXPECT_EQ(stage.team.finished(0, id), nullptr) << stage.team.finished(0, id)->reason;
  answer(0, {36}, false);
  stage.run_for(100ms);
  EXPECT_GE(symbols(), 36);
  answer(1, {}, true);
  stage.run_for(10ms);
  ASSERT_NE(stage.team.finished(0, id), nullptr);
  EXPECT_TRUE(stage.team.finished(0, id)->delivered);
}

TEST(GroupRoom, IsGivenUpAfterAMinute) {
  transport::RoundTrip round_trip(30ms, 10ms, 200ms);
  const multicast::GroupPacket packet(noise(1000), 500);
  multicast::Distribution distribution(packet, round_trip, 0);
  const MacAddress child{{2}};
  distribution.set_children({{child, 0}}, true, 0s);
  const air::AirClock air(1500);
  const Timings timings = robot_timings();
  const routing::Neighbors neighbors(timings, 250ms);
  const multicast::Carriage carriage(air, neighbors);
  while (distribution.has_frame()) distribution.next(carriage, 0s);
  wire::GroupReport report;
  report.first_block = wire::kNoRoom;
  int questions = 0;
  Time now = 0s;
  for (; distribution.stuck(now).empty() && now < 100s; now = distribution.next_deadline()) {
    questions += static_cast<int>(distribution.poll({}, now).size());
    distribution.reported(child, report, false, now);
  }
  EXPECT_NEAR(static_cast<double>(now.count()) * 1e-9, 60.0, 0.2);
  EXPECT_NEAR(questions, 600, 10);
}

/// Each packet that somebody far behind a child misses would otherwise be asked for by itself.
TEST(GroupQuestions, OfSeveralPacketsWhoseEndIsAwaitedTheFirstIsAskedFor) {
  transport::RoundTrip round_trip(30ms, 10ms, 200ms);
  const multicast::GroupPacket packet(noise(400), 500);
  const MacAddress child{{2}};
  const air::AirClock air(1500);
  const Timings timings = robot_timings();
  const routing::Neighbors neighbors(timings, 250ms);
  const multicast::Carriage carriage(air, neighbors);
  const auto questions = [&](const std::set<MacAddress>& behind, bool has_it_itself) {
    multicast::Distribution distribution(packet, round_trip, 0);
    distribution.set_children({{child, 0}}, true, 0s);
    while (distribution.has_frame()) distribution.next(carriage, 0s);
    wire::GroupReport report;
    report.round = 1;
    report.first_block = 1;
    if (has_it_itself) distribution.reported(child, report, false, 1ms);
    std::size_t asked = 0;
    for (Time now = 0s; now < 5s; now = std::max(distribution.next_deadline(), now + 1ms)) {
      asked += distribution.poll(behind, now).size();
    }
    return asked;
  };
  EXPECT_GE(questions({}, true), 2u);
  EXPECT_EQ(questions({child}, true), 0u) << "an earlier packet is open there";
  EXPECT_GE(questions({child}, false), 10u) << "it misses the packet itself";
}

/// Of a packet, as the root's neighbour passes it on.
wire::GroupData user_packet(const Host& root, std::uint32_t number, std::uint32_t base) {
  const auto image = transport::encode({transport::PacketKind::kUser, 'A', "mc_" + root.name, "topic", {1, 2, 3}});
  wire::GroupData data;
  data.root = root.address;
  data.root_boot = root.boot();
  data.stream = 2;
  data.report = true;
  data.round = 1;
  data.packet = number;
  data.base = base;
  data.total = static_cast<std::uint32_t>(image->size());
  data.segment_size = 1000;
  data.octets = *image;
  return data;
}

TEST(GroupRoom, PacketsDoneWithHereKeepNoFurtherOnesOut) {
  Stage stage(without_groups());
  Host& root = stage.neighbor(1);
  stage.run_for(1s);
  stage.node().join_group("mc_host_1", stage.now());
  stage.say(root, wire::GroupActivation{root.address, root.boot(), 1, {stage.self().address}}, stage.self().address);
  stage.run_for(20ms);
  // Some other member has still to get packet 1, so that the root does not go on.
  const std::uint32_t count = 2 * multicast::Sink::kMostTransfers;
  for (std::uint32_t number = 1; number <= count; ++number) {
    stage.say(root, user_packet(root, number, 1));
    stage.run_for(5ms);
  }
  EXPECT_EQ(stage.team.received(0).size(), count);
}

/// The root does not go on, and asks for ever: they held all the room.
TEST(GroupRoom, PacketsDoneWithMakeItAndAreNotTakenAnew) {
  Stage stage(without_groups(small()));
  Host &root = stage.neighbor(1), &honest = stage.neighbor(9);
  stage.run_for(1s);
  stage.node().join_group("mc_host_1", stage.now());
  stage.say(root, wire::GroupActivation{root.address, root.boot(), 1, {stage.self().address}}, stage.self().address);
  stage.run_for(20ms);
  const auto image = transport::encode({transport::PacketKind::kUser, 'A', "mc_host_1", "topic", noise(90'000)});
  const multicast::GroupPacket packet(*image, 1400);
  ASSERT_EQ(packet.blocks().size(), 1u);
  wire::GroupData data = user_packet(root, 1, 1);
  data.total = packet.total();
  data.segment_size = packet.segment_size();
  for (data.packet = 1; data.packet <= 4; ++data.packet) {
    for (int symbol = 0; symbol < packet.blocks()[0].frames(); ++symbol) {
      data.report = false;
      data.symbol = static_cast<std::uint8_t>(symbol);
      data.octets = packet.symbol(0, symbol);
      stage.say(root, data);
    }
    stage.run_for(20ms);
  }
  ASSERT_EQ(stage.team.received(0).size(), 4u);

  const auto own = transport::encode({transport::PacketKind::kUser, 'A', {}, "topic", noise(90'000)});
  wire::Data segment = data_for(stage.self(), honest);
  segment.total = static_cast<std::uint32_t>(own->size());
  segment.segment_size = 1400;
  for (std::size_t begin = 0; begin < own->size(); begin += 1400, ++segment.index) {
    const auto end = static_cast<std::ptrdiff_t>(std::min(begin + 1400, own->size()));
    segment.octets.assign(own->begin() + static_cast<std::ptrdiff_t>(begin), own->begin() + end);
    stage.say(honest, segment);
  }
  stage.run_for(10ms);
  EXPECT_EQ(stage.team.received(0).size(), 5u);

  data.report = true;
  data.octets.clear();
  for (data.packet = 1; data.packet <= 4; ++data.packet) {
    stage.forget();
    stage.say(root, data);
    stage.run_for(20ms);
    const auto reports = stage.sent<wire::GroupReport>();
    ASSERT_FALSE(reports.empty());
    EXPECT_TRUE(reports.back().message.complete) << data.packet;
    EXPECT_EQ(reports.back().message.first_block, 1u) << data.packet;
  }
  EXPECT_EQ(stage.node().queues().group_octets, 0u);
  EXPECT_LT(stage.node().queues().complete_group_octets, 4 * packet.total());
}

TEST(GroupRoom, AMemberServedByCopiesGoesOnWithTheTreeWhoeverIsHeardFirst) {
  Stage stage(without_groups());
  Host &upstream = stage.neighbor(1), &other = stage.neighbor(2);
  stage.run_for(1s);
  const Host root = kFar;
  stage.give_route(upstream, root);
  stage.node().join_group("mc_" + root.name, stage.now());
  stage.run_for(20ms);
  multicast::HeldPacket held;
  held.stream = 2;
  held.number = 3;
  held.image = transport::encode({transport::PacketKind::kUser, 'A', "mc_" + root.name, "topic", {3}});
  const auto copy =
      transport::encode({transport::PacketKind::kGroupCopy, 0, "mc_" + root.name, {}, multicast::encode_copy(held)});
  wire::Data data = data_for(stage.self(), root);
  data.stream = 2;
  data.total = static_cast<std::uint32_t>(copy->size());
  data.segment_size = 1000;
  data.octets = *copy;
  stage.say(upstream, data, stage.self().address);
  stage.run_for(20ms);
  stage.say(upstream, wire::GroupActivation{root.address, root.boot(), 1, {stage.self().address}},
            stage.self().address);
  stage.run_for(20ms);
  stage.say(other, user_packet(root, 6, 6));
  stage.run_for(5ms);
  stage.say(upstream, user_packet(root, 6, 6));
  stage.run_for(2s);
  EXPECT_EQ(stage.team.received(0).size(), 2u);
}

}  // namespace
}  // namespace adhoc_communication
