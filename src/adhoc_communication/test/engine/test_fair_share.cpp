// A relay's own packets beside those of others.
#include <gtest/gtest.h>

#include "air/fair_share.hpp"
#include "host.hpp"
#include "transport/frame_queue.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using air::FairShare;

using Names = std::vector<std::string>;

Names sorted(const FairShare<std::string>& share, Names waiting) {
  share.sort(waiting);
  return waiting;
}

TEST(FairShare, WhoHasSentLeastGoesFirst) {
  FairShare<std::string> share;
  EXPECT_EQ(sorted(share, {"a", "b", "c"}), (Names{"a", "b", "c"}));
  share.charge("a", 1500);
  share.charge("b", 100);
  EXPECT_EQ(sorted(share, {"a", "b", "c"}), (Names{"c", "b", "a"}));
}

TEST(FairShare, SilenceEarnsLittleAndIsForgotten) {
  FairShare<std::string> share;
  for (int i = 0; i < 1000; ++i) share.charge("busy", 1500);
  for (int i = 0; i < 1000; ++i) share.charge("passing " + std::to_string(i), 10);
  EXPECT_LE(share.remembered(), FairShare<std::string>::kMostRemembered);
  std::size_t ahead = 0;
  while (sorted(share, {"busy", "silent"}).front() == "silent") {
    share.charge("silent", 1000);
    ahead += 1000;
  }
  EXPECT_LE(ahead, 2 * FairShare<std::string>::kMostCredit);
}

TEST(FrameQueue, WhoHasMostLosesWhenItIsFull) {
  transport::FrameQueue queue;
  const auto frame = [](std::uint8_t hop, std::uint8_t number) {
    return transport::HopFrame{wire::FrameType::kData, {number}, 0, MacAddress{{hop}}};
  };
  for (std::size_t i = 0; i < transport::FrameQueue::kMostFrames; ++i) EXPECT_TRUE(queue.push(frame(1, 1)));
  EXPECT_FALSE(queue.push(frame(1, 1)));
  for (std::size_t i = 0; i < transport::FrameQueue::kMostFrames / 2; ++i) EXPECT_TRUE(queue.push(frame(2, 2)));
  EXPECT_FALSE(queue.push(frame(2, 2)));
  EXPECT_EQ(queue.size(), transport::FrameQueue::kMostFrames);
}

/// Two neighbours send through the node; the one that sends much filled the queue before the other.
TEST(FairShare, EachPreviousHopHasItsShareOfARelay) {
  Stage stage;
  Host& greedy = stage.neighbor(1);
  Host& modest = stage.neighbor(2);
  Host& beyond = stage.neighbor(3);
  stage.run_for(1s);
  stage.forget();
  const auto pass = [&](Host& from, std::uint32_t count) {
    for (std::uint32_t packet = 1; packet <= count; ++packet) {
      wire::Data data = data_for(beyond, from, packet);
      data.octets = noise(1000);
      data.total = 1000;
      stage.say(from, data, stage.self().address);
    }
  };
  pass(greedy, 300);
  pass(modest, 30);
  stage.run_for(2s);
  std::size_t others = 0;
  std::size_t own = 0;
  for (const auto& [at, to, data] : stage.sent<wire::Data>()) {
    if (own == 30) break;
    ++(data.source == modest.address ? own : others);
  }
  EXPECT_EQ(own, 30u);
  EXPECT_LE(others, 45u) << "its share is half";
}

struct OwnTransfer {
  double seconds = 0;
  double own = 0;      ///< octets that the relay has sent meanwhile, repetitions included
  double passing = 0;  ///< for others, likewise
};

/// 500 kB of a relay's own, over a hop that loses nothing, while `sources` robots send through it without a break to
/// another robot, over a hop that loses `loss`.
OwnTransfer own_transfer(std::size_t sources, double loss) {
  Team team;
  team.add(without_groups(), 0.0);
  team.add(without_groups(), 8.0);
  team.add(without_groups(), 0.0, 8.0);
  for (std::size_t i = 0; i < sources; ++i) team.add(without_groups(), -5.0, i % 2 == 0 ? 5.0 : -5.0);
  team.medium().set_link_loss(0, 1, loss);
  team.run_for(2s);
  std::vector<SendId> passing;
  for (std::size_t i = 0; i < sources; ++i) {
    passing.push_back(team.send(3 + i, "robot_1", noise(8'000'000), Priority::kBulk));
  }
  team.run_for(500ms);
  OwnTransfer transfer;
  team.on_transmission = [&](std::size_t robot, const Frame& frame) {
    if (robot != 0 || frame.bytes[1] != static_cast<std::uint8_t>(wire::FrameType::kData)) return;
    (frame.destination == Team::address(2) ? transfer.own : transfer.passing) +=
        static_cast<double>(frame.bytes.size());
  };
  const Time begin = team.now();
  const SendId own = team.send(0, "robot_2", noise(500'000), Priority::kBulk);
  EXPECT_TRUE(team.run_until_done([&] { return team.finished(0, own) != nullptr; }, 20s));
  EXPECT_TRUE(team.finished(0, own) != nullptr && team.finished(0, own)->delivered);
  for (std::size_t i = 0; i < sources; ++i) EXPECT_EQ(team.finished(3 + i, passing[i]), nullptr) << "no transit";
  transfer.seconds = static_cast<double>((team.now() - begin).count()) * 1e-9;
  return transfer;
}

/// Frames of others went first, so that under constant transit a relay's own packets waited for ever.
TEST(FairShare, ARelaySendsBesideConstantTransit) {
  const double alone = own_transfer(0, 0.0).seconds;
  for (const double loss : {0.0, 0.1, 0.3}) {
    EXPECT_LE(own_transfer(1, loss).seconds, 2 * 2 * alone) << loss;
    EXPECT_LE(own_transfer(2, loss).seconds, 2 * 3 * alone) << loss;
  }
}

/// What was lost was repeated before anything else and charged to nobody: where the others' next hop loses much, its
/// repetitions went at the cost of the relay's own packets.
TEST(FairShare, WhoseFramesALossyHopRepeatsPaysForThat) {
  for (const double loss : {0.1, 0.3, 0.5}) {
    const OwnTransfer transfer = own_transfer(1, loss);
    EXPECT_GE(transfer.own, 0.9 * transfer.passing) << loss;
  }
}

}  // namespace
}  // namespace adhoc_communication
