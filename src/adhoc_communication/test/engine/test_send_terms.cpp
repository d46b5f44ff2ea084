// Lifetimes of sends, and newer packets in the place of older ones.
#include <gtest/gtest.h>

#include "host.hpp"
#include "transport/stream_sender.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

SendRequest request(const std::string& destination, Bytes payload, Time lifetime, bool newest_only = false,
                    const std::string& topic = "topic") {
  SendRequest request;
  request.destination = destination;
  request.topic = topic;
  request.payload_type = 'A';
  request.payload = std::move(payload);
  request.lifetime = lifetime;
  request.newest_only = newest_only;
  return request;
}

SendId send(Team& team, const SendRequest& request) { return team.engine(0).send(request, team.now()); }

const SendFinished& end_of(Team& team, SendId id) {
  const SendFinished* end = team.finished(0, id);
  if (end == nullptr) throw std::logic_error("the send has not ended");
  return *end;
}

/// Robot 0 at a slow radio, so that packets wait.
MediumOptions slow() {
  MediumOptions medium;
  medium.bit_rate = 1e6;
  return medium;
}

std::vector<std::string> texts(Team& team, std::size_t robot) {
  std::vector<std::string> result;
  for (const auto& [packet, at] : team.received(robot))
    result.emplace_back(packet.payload.begin(), packet.payload.end());
  return result;
}

TEST(Lifetime, EndsASendThatFindsNoRouteInTime) {
  Team team;
  team.add(without_groups());
  const SendId id = send(team, request("nobody", text("x"), 300ms));
  team.run_for(299ms);
  EXPECT_EQ(team.finished(0, id), nullptr);
  team.run_for(2ms);
  EXPECT_EQ(end_of(team, id).reason, "not delivered within its lifetime of 0.3 s");
  EXPECT_EQ(team.engine(0).queues().packets, 0u);
}

/// The others go on, in order, whether the one that ended had begun, waited, or had arrived out of turn.
TEST(Lifetime, OthersOfTheStreamGoOn) {
  Team team(slow());
  team.add_line(2, without_groups());
  team.run_for(1s);
  const SendId begun = send(team, request("robot_1", noise(200'000), 200ms));
  const SendId waiting = send(team, request("robot_1", text("late"), 100ms));
  const SendId lasting = send(team, request("robot_1", text("lasting"), 0s));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, lasting) != nullptr; }, 3s));
  EXPECT_FALSE(end_of(team, waiting).delivered);
  EXPECT_FALSE(end_of(team, begun).delivered);
  EXPECT_TRUE(end_of(team, lasting).delivered);
  EXPECT_EQ(texts(team, 1), std::vector<std::string>{"lasting"});
  EXPECT_LT(team.now(), 2s) << "what has ended still took its time on the air";
}

TEST(Lifetime, IsNotHeldAgainstAPacketThatArrives) {
  Team team;
  team.add_line(3, without_groups());
  team.run_for(1s);
  const SendId id = send(team, request("robot_2", text("x"), 1s));
  team.run_for(2s);
  EXPECT_TRUE(end_of(team, id).delivered);
}

/// A packet behind the one that ended may be complete at the receiver, where nothing of it would be sent any more.
TEST(Lifetime, ReceiverIsToldToPassItOver) {
  transport::StreamSender sender(2, 7, 768);
  const auto image = [](std::size_t size) { return std::make_shared<const Bytes>(size); };
  sender.add(1, image(100), 100, 0s);
  sender.add(2, image(100), 100, 0s);
  sender.next_segment(0s);
  sender.next_segment(0s);
  wire::TransportAcknowledgment acknowledgment;
  acknowledgment.source_boot = 1;
  acknowledgment.next = 7;
  acknowledgment.partial.push_back({8, 0, 1, {}});
  sender.acknowledged(acknowledgment, 1ms);
  EXPECT_FALSE(sender.has_segment());
  sender.drop(1, 1ms);
  ASSERT_TRUE(sender.has_segment());
  const wire::Data told = sender.next_segment(2ms);
  EXPECT_EQ(told.packet, 8u);
  EXPECT_EQ(told.base, 8u);
  EXPECT_TRUE(told.acknowledge_now);
  acknowledgment.next = 9;
  acknowledgment.partial.clear();
  EXPECT_EQ(sender.acknowledged(acknowledgment, 3ms), std::vector<SendId>{2});
  EXPECT_TRUE(sender.idle());
  EXPECT_EQ(sender.next_deadline(), Time::max());
}

TEST(Lifetime, OfAGroupSendNamesWhoIsMissing) {
  Team team;
  team.add_line(3);
  team.run_for(5s);
  team.kill(2);
  const SendId id = send(team, request("mc_robot_0", noise(2000), 500ms));
  team.run_for(600ms);
  EXPECT_EQ(end_of(team, id).reason, "not delivered to robot_2 within its lifetime of 0.5 s");
  const SendId next = send(team, request("mc_robot_0", text("next"), 0s));
  ASSERT_TRUE(team.run_until_done([&] { return team.finished(0, next) != nullptr; }, 10s));
  EXPECT_EQ(team.received(1).size(), 2u);
}

TEST(Lifetime, EndsABroadcastThatWaits) {
  Team team(slow());
  team.add_line(2, without_groups());
  team.run_for(1s);
  const SendId first = send(team, request("", noise(60'000), 0s));
  const SendId second = send(team, request("", text("late"), 100ms));
  team.run_for(2s);
  EXPECT_TRUE(end_of(team, first).delivered);
  EXPECT_FALSE(end_of(team, second).delivered);
}

/// A topic twice as fast as the radio: what arrives is new, and two topics share the way.
TEST(NewestOnly, TakesThePlaceOfWhatHasNotBegun) {
  for (const std::string destination : {"robot_1", "", "mc_robot_0"}) {
    MediumOptions medium;
    medium.bit_rate = 6e6;
    Team team(medium);
    team.add_line(2, destination == "mc_robot_0" ? EngineOptions{} : without_groups());
    team.run_for(3s);
    std::map<std::string, std::vector<Time>> ages;
    std::map<std::pair<std::string, std::size_t>, Time> sent_at;
    std::vector<SendId> ids;
    for (std::size_t i = 0; i < 40; ++i) {
      for (const std::string topic : {"a", "b"}) {
        sent_at[{topic, i}] = team.now();
        Bytes payload = noise(30'000);
        payload[0] = static_cast<std::uint8_t>(i);
        ids.push_back(send(team, request(destination, std::move(payload), 0s, true, topic)));
      }
      team.run_for(40ms);
    }
    team.run_for(1s);
    std::size_t superseded = 0;
    for (const SendId id : ids) {
      superseded += end_of(team, id).superseded ? 1 : 0;
      EXPECT_TRUE(end_of(team, id).delivered || end_of(team, id).superseded) << end_of(team, id).reason;
    }
    for (const auto& [packet, at] : team.received(1)) {
      ages[packet.topic].push_back(at - sent_at[{packet.topic, packet.payload[0]}]);
    }
    EXPECT_GT(superseded, 20u) << destination;
    for (const std::string topic : {"a", "b"}) {
      EXPECT_GT(ages[topic].size(), 10u) << destination;
      const Time oldest = *std::max_element(ages[topic].begin(), ages[topic].end());
      // Packets for a group begin before those before have been reported.
      EXPECT_LT(oldest, destination == "mc_robot_0" ? 700ms : 250ms) << destination;
    }
    EXPECT_EQ(team.received(1).back().packet.payload[0], 39) << destination;
  }
}

TEST(NewestOnly, LeavesOtherTopicsAndDestinationsAlone) {
  Team team(slow());
  team.add_line(2, without_groups());
  team.run_for(1s);
  send(team, request("robot_1", noise(20'000), 0s));
  send(team, request("robot_1", text("kept"), 0s));
  send(team, request("robot_1", text("other topic"), 0s, true, "other"));
  const SendId former = send(team, request("robot_1", text("former"), 0s, true));
  send(team, request("robot_1", text("newest"), 0s, true));
  EXPECT_EQ(team.engine(0).queues().packets, 4u);
  team.run_for(2s);
  EXPECT_EQ(end_of(team, former).reason, "a newer packet for topic 'topic' has taken its place");
  std::vector<std::string> received = texts(team, 1);
  received.erase(received.begin());
  EXPECT_EQ(received, (std::vector<std::string>{"kept", "other topic", "newest"}));
}

}  // namespace
}  // namespace adhoc_communication
