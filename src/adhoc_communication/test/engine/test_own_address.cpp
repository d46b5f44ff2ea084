// Who transmits with the address of another robot, as a run of it that nobody knows: in an open team anybody in range,
// in a sealed one somebody who holds the key.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adversary_suite.hpp"
#include "transport/packet_image.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

class AdversarySuiteWithAnAddress : public AdversarySuite {
 protected:
  static constexpr int kKinds = 8;

  /// Another run of the robot than that which lives.
  std::unique_ptr<Insider> impostor(std::size_t victim, int run) {
    Host host = make_host(0);
    host.name = Team::name(victim);
    host.address = Team::address(victim);
    host.boot_id = {0x99, static_cast<std::uint8_t>(victim), static_cast<std::uint8_t>(run >> 8),
                    static_cast<std::uint8_t>(run)};
    return std::make_unique<Insider>(team_, host, options_.keys);
  }

  /// A beacon that names the robot, and something else.
  void speak(Insider& impostor, std::size_t robot, int kind) {
    impostor.prove(robot);
    const Host& self = impostor.host();
    switch (kind % kKinds) {
      case 0:
        return impostor.say(robot, data_for(impostor.robot(robot), self, ++packet_));
      case 1:
        return impostor.say(robot, request_for(make_host(8), self, ++packet_));
      case 2:
        return impostor.say(robot, reply_about(self, impostor.robot(robot)));
      case 3:
        return impostor.say(robot, error_about({{impostor.robot(2), 1000}}));
      case 4:
        return impostor.demand_acknowledgment(robot);
      case 5:
        return impostor.say(robot, acknowledgment_of(self, impostor.robot(robot), 1'000'000));
      case 6:
        return impostor.say(robot, wire::GroupActivation{self.address, self.boot(), 1, {Team::address(robot)}});
      default:
        return impostor.say(robot, wire::FrameType::kBroadcastData,
                            wire::to_bytes(wire::BroadcastData{++packet_, 0, 3, 1000, text("abc")}));
    }
  }

  static std::size_t victim_of(std::size_t robot, int turn) {
    return (robot + 1 + static_cast<std::size_t>(turn) % 2) % kRobots;
  }
  /// So many times a second, each time as another run.
  Attack of_ever_new_runs(int rate) {
    return [this, every = static_cast<int>(1s / kStep) / rate](int step, std::size_t robot) {
      if (step % every != 0) return;
      speak(*impostor(victim_of(robot, step / every), ++run_), robot, step / every);
    };
  }
  /// So many times a second, as the same run of the next robot.
  Attack of_one_run(int rate) {
    for (std::size_t robot = 0; robot < kRobots; ++robot) lasting_.push_back(impostor((robot + 1) % kRobots, 0));
    return [this, every = static_cast<int>(1s / kStep) / rate](int step, std::size_t robot) {
      if (step % every == 0) speak(*lasting_[robot], robot, step / every);
    };
  }
  void go_on(const Attack& attack, Time duration) {
    for (int step = 0; step * kStep < duration; ++step) {
      for (std::size_t robot = 0; robot < kRobots; ++robot) {
        if (team_.alive(robot)) attack(step, robot);
      }
      team_.run_for(kStep);
    }
  }
  /// He has sent packets of one octet, and of three.
  void expect_nothing_forged() {
    for (std::size_t robot = 0; robot < kRobots; ++robot) {
      for (const Team::Received& received : team_.received(robot)) EXPECT_GE(received.packet.payload.size(), 1000u);
    }
  }

  std::vector<std::unique_ptr<Insider>> lasting_;
  std::uint32_t packet_ = 0;
  int run_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Open, AdversarySuiteWithAnAddress, testing::Values(false));
INSTANTIATE_TEST_SUITE_P(Sealed, AdversarySuiteWithAnAddress, testing::Values(true));

/// One frame ended the link, the streams and the routes of the robot that lives, and it had to say three to come back.
TEST_P(AdversarySuiteWithAnAddress, EverNewRunsDeafenNobody) {
  for (const int rate : {1, 5, 20}) withstand(of_ever_new_runs(rate));
  expect_nothing_forged();
}

TEST_P(AdversarySuiteWithAnAddress, ARunThatGoesOnDeafensNobody) {
  for (const int rate : {1, 5, 20}) withstand(of_one_run(rate));
  expect_nothing_forged();
}

/// Over links that lose every third frame. The robots rest, so that a beacon a second is all that is heard of them.
TEST_P(AdversarySuiteWithAnAddress, NorWhereFramesGetLost) {
  for (std::size_t a = 0; a < kRobots; ++a) {
    for (std::size_t b = 0; b < a; ++b) team_.medium().set_link_loss(a, b, 0.3);
  }
  team_.run_for(2s);
  for (const Attack& attack : {of_ever_new_runs(20), of_one_run(20)}) {
    go_on(attack, 20s);
    for (std::size_t robot = 0; robot < kRobots; ++robot) expect_nobody_lost(robot);
  }
}

/// He acknowledges whatever is sent to the robot, as it does.
TEST_P(AdversarySuiteWithAnAddress, NorWhoAnswersForARobotThatDoes) {
  const auto forger = impostor(1, 0);
  std::vector<wire::FrameHeader> owed;
  team_.on_transmission = [&](std::size_t robot, const Frame& frame) {
    wire::Reader reader(frame.bytes);
    const auto header = wire::read_header(reader);
    const bool wanted = robot == 0 && header && header->next_hop == forger->host().address &&
                        (header->flags & wire::kWantsAcknowledgment) != 0;
    if (wanted) owed.push_back(*header);
  };
  withstand([&](int step, std::size_t robot) {
    if (robot != 0) return;
    if (step % 5 == 0) speak(*forger, robot, step / 5);
    for (const wire::FrameHeader& header : std::exchange(owed, {})) {
      wire::HopAcknowledgment acknowledgment;
      acknowledgment.boot = wire::boot_tag(team_.boot_id(0));
      acknowledgment.newest_counter = header.counter;
      acknowledgment.highest = header.link_sequence;
      acknowledgment.received = ~std::uint64_t{0};
      forger->say(robot, acknowledgment);
    }
  });
  team_.on_transmission = nullptr;
}

TEST_P(AdversarySuiteWithAnAddress, AreToldOf) {
  go_on(of_one_run(1), 8s);
  for (std::size_t robot = 0; robot < kRobots; ++robot) {
    const std::string word = "=" + Team::name((robot + 1) % kRobots);
    const auto& words = team_.presence(robot);
    EXPECT_EQ(std::count_if(words.begin(), words.end(), [&](const auto& item) { return item.second == word; }), 1);
  }
}

/// It is the robot itself that speaks as a run that nobody knows.
TEST_P(AdversarySuiteWithAnAddress, ARestartIsBelievedMeanwhile) {
  const Attack attack = of_ever_new_runs(20);
  for (const Time dead : {0s, 1s, 4s}) {
    team_.kill(1);
    go_on(attack, dead);
    team_.restart(1);
    go_on(attack, 3s);
    const SendId id = team_.send(1, "robot_0", noise(1000));
    go_on(attack, 1s);
    expect_delivered(1, id);
  }
}

/// He was there first, and goes on transmitting.
TEST_P(AdversarySuiteWithAnAddress, WhoOnlyTransmitsKeepsNoNewcomerOut) {
  const auto squatter = impostor(kRobots, 0);
  const Attack attack = [&](int step, std::size_t robot) {
    if (step % 5 == 0) squatter->prove(robot);
  };
  go_on(attack, 1s);
  team_.add(options_);
  go_on(attack, 4s);
  const SendId id = team_.send(kRobots, "robot_0", noise(1000));
  go_on(attack, 1s);
  expect_delivered(kRobots, id);
}

/// Robots that there are not, each frame as another run of one of them: every one was asked, again and again.
TEST_P(AdversarySuiteWithAnAddress, MadeUpRobotsCostFewQuestions) {
  std::size_t questions = 0;
  team_.on_transmission = [&](std::size_t robot, const Frame& frame) {
    const bool is_beacon = frame.bytes[1] == static_cast<std::uint8_t>(wire::FrameType::kBeacon);
    questions += robot == 0 && is_beacon && frame.destination != wire::kEverybody;
  };
  go_on(
      [&](int, std::size_t robot) {
        for (int i = 0; i < 5; ++i, ++run_) impostor(50 + static_cast<std::size_t>(run_) % 200, run_)->prove(robot);
      },
      5s);
  team_.on_transmission = nullptr;
  EXPECT_GT(questions, 0u);
  EXPECT_LE(questions, 5u * 32u * 10u) << "each goes out a few times";
}

}  // namespace
}  // namespace adhoc_communication
