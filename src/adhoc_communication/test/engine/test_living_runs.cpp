// Which run of a robot is believed to live, whatever is said of it.
#include <gtest/gtest.h>

#include <algorithm>

#include "host.hpp"
#include "random.hpp"
#include "routing/living_runs.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using routing::LivingRuns;

const MacAddress kRobot = {0x02, 0, 0, 0, 0, 7};
constexpr wire::BootTag kEnded = 1;
constexpr wire::BootTag kLiving = 2;
constexpr wire::BootTag kForged = 3;

/// The living run was known by hearsay, then late hearsay of the ended one displaced it.
struct Displaced {
  Displaced() {
    runs.told_alive(kRobot, kLiving, 1, 10s);
    runs.told_alive(kRobot, kEnded, 30, 10s);
  }
  /// Second by second, the living run is told of.
  void hear_of_it(std::uint32_t first, std::uint32_t last, Time begin) {
    for (std::uint32_t sign = first; sign <= last; ++sign) {
      runs.told_alive(kRobot, kLiving, sign, begin + (sign - first) * 1s);
    }
  }
  LivingRuns runs;
};

TEST(LivingRuns, ARunThatGoesOnIsReinstated) {
  Displaced displaced;
  ASSERT_FALSE(displaced.runs.lives(kRobot, kLiving));
  displaced.hear_of_it(2, 6, 11s);
  EXPECT_TRUE(displaced.runs.lives(kRobot, kLiving));
  EXPECT_FALSE(displaced.runs.told(kRobot, kEnded, 15s));
}

TEST(LivingRuns, AnEndedRunStaysEnded) {
  LivingRuns runs;
  runs.told_alive(kRobot, kEnded, 30, 10s);
  runs.heard(kRobot, kLiving, 1, 11s);
  runs.told_alive(kRobot, kEnded, 31, 11s);
  runs.told_alive(kRobot, kEnded, 31, 16s);  // whose second 31 was told, never 33
  EXPECT_TRUE(runs.lives(kRobot, kLiving));
}

TEST(LivingRuns, WhatLivesIsNotDisplacedWhileItIsHeardOf) {
  Displaced displaced;
  displaced.runs.told_alive(kRobot, kEnded, 31, 11s);
  displaced.runs.told_alive(kRobot, kLiving, 9, 12s);
  EXPECT_TRUE(displaced.runs.lives(kRobot, kEnded));
}

TEST(LivingRuns, HearsayDoesNotDisplaceARunHeardLately) {
  LivingRuns runs;
  ASSERT_TRUE(runs.heard(kRobot, kLiving, 1, 10s));
  EXPECT_FALSE(runs.told(kRobot, kForged, 11999ms));
  EXPECT_FALSE(runs.told_alive(kRobot, kForged, 99, 11999ms));
  EXPECT_TRUE(runs.lives(kRobot, kLiving));
  EXPECT_TRUE(runs.told(kRobot, kForged, 12s)) << "it may have started again out of reach";
}

TEST(LivingRuns, ARunHeardItselfIsReinstatedAtOnceWhereTheOtherIsNotHeard) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 5, 10s);
  runs.told_alive(kRobot, kLiving, 30, 10s);
  runs.told(kRobot, kForged, 13s);
  runs.beacon(kRobot, kLiving, 33, 13s);
  EXPECT_TRUE(runs.heard(kRobot, kLiving, 6, 13s));
  EXPECT_TRUE(runs.lives(kRobot, kLiving));
}

/// A frame that nobody had heard then, from before the robot's crash, displaced the run that was known by hearsay.
TEST(LivingRuns, A2_5_WhatAnEndedRunSaidUnheardDoesNotBringItBack) {
  for (const std::uint32_t last_sign : {30u, 32u}) {
    LivingRuns runs;
    runs.heard(kRobot, kEnded, 40, 10s);
    runs.told_alive(kRobot, kEnded, 30, 10s);
    runs.told_alive(kRobot, kLiving, 1, 14s);
    for (std::uint64_t counter = 41; counter <= 80; ++counter) {
      runs.beacon(kRobot, kEnded, last_sign, 20s + counter * 1ms);
      EXPECT_FALSE(runs.heard(kRobot, kEnded, counter, 20s + counter * 1ms)) << counter;
    }
    runs.told_alive(kRobot, kEnded, 33, 24s);
    EXPECT_TRUE(runs.lives(kRobot, kLiving));
  }
}

/// Of a run told of by requests only, the first life sign may be a recorded one; a row of them has to grow.
TEST(LivingRuns, ARunWithoutALifeSignHasToShowTwo) {
  for (const bool lives : {true, false}) {
    LivingRuns runs;
    runs.told(kRobot, kLiving, 10s);
    runs.told(kRobot, kForged, 10s);
    std::uint64_t counter = 0;
    for (std::uint32_t second = 0; second < 4; ++second) {
      EXPECT_FALSE(runs.lives(kRobot, kLiving)) << second;
      runs.beacon(kRobot, kLiving, 50 + (lives ? second : 0), 20s + second * 1s);
      runs.heard(kRobot, kLiving, ++counter, 20s + second * 1s);
    }
    EXPECT_EQ(runs.lives(kRobot, kLiving), lives);
  }
}

/// A frame of that run, every 50 ms.
bool goes_on(LivingRuns& runs, wire::BootTag boot, std::uint64_t counter, Time begin, Time duration) {
  bool believed = false;
  for (Time now = begin; now < begin + duration; now += 50ms) believed = runs.heard(kRobot, boot, counter++, now);
  return believed;
}

TEST(LivingRuns, LateFramesOfAnEndedRunDoNotBringItBack) {
  LivingRuns runs;
  runs.heard(kRobot, kEnded, 100, 10s);
  ASSERT_TRUE(runs.heard(kRobot, kLiving, 1, 10s + LivingRuns::kGone)) << "a restart is believed at once";
  EXPECT_FALSE(runs.heard(kRobot, kEnded, 101, 15s)) << "it was in the air";
  for (std::uint64_t counter = 90; counter <= 101; ++counter) {
    EXPECT_FALSE(runs.heard(kRobot, kEnded, counter, 24s)) << "recorded, " << counter;
  }
  EXPECT_TRUE(runs.lives(kRobot, kLiving));
}

TEST(LivingRuns, ARestartIsBelievedOnceTheFormerRunIsAskedAndSilent) {
  for (const bool answers : {true, false}) {
    LivingRuns runs;
    runs.heard(kRobot, kEnded, 100, 10s);
    EXPECT_FALSE(runs.heard(kRobot, kLiving, 1, 11s, answers));
    EXPECT_TRUE(runs.wants_answer(kRobot, true, 11s));
    EXPECT_FALSE(runs.wants_answer(kRobot, true, 11s)) << "it has just been asked";
    const Time end = answers ? 11300ms : 11600ms;
    EXPECT_FALSE(runs.heard(kRobot, kLiving, 2, end - 1ms, answers));
    EXPECT_TRUE(runs.heard(kRobot, kLiving, 3, end, answers));
    EXPECT_FALSE(runs.wants_answer(kRobot, true, 12s));
  }
}

/// One frame with its address ended the run that lives, and it had to say three to come back.
TEST(LivingRuns, ARunThatAnswersLives) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 1, 10s);
  int questions = 0;
  for (Time now = 10s; now < 20s; now += 50ms) {
    EXPECT_FALSE(runs.heard(kRobot, kForged, static_cast<std::uint64_t>(now / 50ms), now));
    if (!runs.wants_answer(kRobot, true, now)) continue;
    ++questions;
    runs.heard(kRobot, kLiving, 1 + static_cast<std::uint64_t>(questions), now + 1ms, true);
  }
  EXPECT_GE(questions, 5);
  EXPECT_LE(questions, 10) << "one frame of his is not to cost one of each neighbour";
}

/// Who had the address first, and answers nothing, kept the robot out that it belongs to.
TEST(LivingRuns, ARunThatOnlyTransmitsGivesWay) {
  LivingRuns runs;
  runs.heard(kRobot, kForged, 1, 10s);
  for (Time now = 10s; now < 11s; now += 50ms) {
    runs.heard(kRobot, kForged, static_cast<std::uint64_t>(now / 50ms), now);
    EXPECT_FALSE(runs.heard(kRobot, kLiving, static_cast<std::uint64_t>(now / 50ms), now + 1ms, true));
  }
  EXPECT_TRUE(runs.heard(kRobot, kLiving, 1000, 11001ms, true));
}

/// While nothing of the robot was heard here, somebody else took its address.
TEST(LivingRuns, ARunThatGoesOnTransmittingOutlivesAForgedOne) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 100, 10s);
  runs.heard(kRobot, kForged, 1, 10s);
  ASSERT_TRUE(runs.wants_answer(kRobot, true, 10s));
  ASSERT_TRUE(runs.heard(kRobot, kForged, 2, 10600ms));
  EXPECT_FALSE(runs.heard(kRobot, kLiving, 101, 10610ms));
  EXPECT_TRUE(runs.heard(kRobot, kLiving, 102, 10910ms, true));
}

TEST(LivingRuns, TwoRobotsWithOneAddressAreToldOf) {
  LivingRuns runs;
  for (Time now = 10s; now < 16s; now += 500ms) {
    runs.heard(kRobot, kLiving, static_cast<std::uint64_t>(now / 50ms), now, true);
    EXPECT_EQ(runs.contested(kRobot, now), now > 10s + LivingRuns::kContested) << now.count();
    runs.heard(kRobot, kForged, static_cast<std::uint64_t>(now / 50ms), now);
  }
  EXPECT_TRUE(runs.any_contested(16s));
  EXPECT_FALSE(runs.contested(kRobot, 18s)) << "he has stopped";
  EXPECT_FALSE(runs.any_contested(18s));
}

/// Frames of ever new runs of made-up robots cost a dozen each.
TEST(LivingRuns, QuestionsAreBounded) {
  LivingRuns runs;
  int questions = 0;
  for (Time now = 10s; now < 12s; now += 1ms) {
    for (const bool two_way : {false, true}) {
      const MacAddress robot = {6, 0, 0, 0, two_way, static_cast<std::uint8_t>(now / 1ms % 250)};
      runs.heard(robot, static_cast<wire::BootTag>(now.count()), 1, now);
      const bool asked = runs.wants_answer(robot, two_way, now);
      EXPECT_TRUE(two_way || !asked);
      questions += asked;
    }
  }
  EXPECT_GT(questions, LivingRuns::kMostQuestions);
  EXPECT_LE(questions, 2 * LivingRuns::kMostQuestions);
}

TEST(LivingRuns, ARunThatThereWasNoTimeToAskIsGivenLonger) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 1, 10s);
  runs.heard(kRobot, kForged, 1, 10s);
  for (std::uint8_t i = 0; i < 2 * LivingRuns::kMostQuestions; ++i) {
    runs.heard({6, 0, 0, 0, 0, i}, 1, 1, 10s);
    runs.heard({6, 0, 0, 0, 0, i}, 2, 1, 10s);
    runs.wants_answer({6, 0, 0, 0, 0, i}, true, 10s);
  }
  EXPECT_FALSE(runs.wants_answer(kRobot, true, 10s));
  EXPECT_FALSE(runs.heard(kRobot, kForged, 2, 10900ms, true));
  runs.heard(kRobot, kLiving, 2, 10950ms);
  EXPECT_FALSE(runs.heard(kRobot, kForged, 3, 11s, true));
}

/// Its link has been given up, so nothing is at stake.
TEST(LivingRuns, ARunThatWasSilentAndHearsNobodyGivesWayAtOnce) {
  LivingRuns runs;
  runs.heard(kRobot, kEnded, 1, 10s);
  EXPECT_FALSE(runs.heard(kRobot, kLiving, 1, 12s));
  EXPECT_FALSE(runs.wants_answer(kRobot, false, 12s));
  EXPECT_TRUE(runs.heard(kRobot, kLiving, 2, 12001ms));
}

/// In a sealed team a new run proves itself meanwhile.
TEST(LivingRuns, ABeaconOfARunThatIsNotProvenBeginsTheDoubt) {
  LivingRuns runs;
  runs.heard(kRobot, kEnded, 1, 10s);
  runs.suspected(kRobot, kLiving, 11s);
  EXPECT_TRUE(runs.wants_answer(kRobot, true, 11s));
  EXPECT_FALSE(runs.heard(kRobot, kLiving, 1, 11299ms, true));
  EXPECT_TRUE(runs.heard(kRobot, kLiving, 2, 11300ms, true));
}

/// Recorded ones are no second robot.
TEST(LivingRuns, BeaconsOfRunsThatAreNotProvenDisplaceNobody) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 1, 10s);
  for (Time now = 10s; now < 14s; now += 50ms) runs.suspected(kRobot, kForged, now);
  EXPECT_TRUE(runs.lives(kRobot, kLiving));
  EXPECT_FALSE(runs.contested(kRobot, 14s));
}

/// Where robots do not acknowledge frames nobody can be asked.
TEST(LivingRuns, WithoutQuestionsThreeBeaconsHaveToBeMissing) {
  LivingRuns runs(false);
  runs.heard(kRobot, kEnded, 100, 10s);
  EXPECT_FALSE(runs.heard(kRobot, kLiving, 1, 10s));
  EXPECT_FALSE(runs.wants_answer(kRobot, true, 10s));
  EXPECT_FALSE(goes_on(runs, kLiving, 2, 10050ms, 3100ms));
  EXPECT_TRUE(runs.heard(kRobot, kLiving, 100, 13200ms));
}

/// A robot that loses half of the questions, or their answers, and restarts at random. Others use its address all the
/// time, and answer nothing.
TEST(LivingRuns, WhoAnswersLivesAndARestartIsBelievedWhateverElseIsHeard) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    LivingRuns runs;
    wire::BootTag living = 1;
    std::uint64_t counter = 0;
    Time deaf_since = 10s;
    for (Time now = 10s; now < 60s; now += 10ms) {
      if (random.chance(0.001)) {
        ++living;
        counter = 0;
        deaf_since = now;
      }
      if (random.chance(0.04)) runs.heard(kRobot, living, ++counter, now);
      if (random.chance(0.3)) runs.heard(kRobot, 1000 + random.next() % 50, ++counter, now);
      if (runs.wants_answer(kRobot, true, now) && random.chance(0.5)) runs.heard(kRobot, living, ++counter, now, true);
      if (runs.lives(kRobot, living)) deaf_since = now;
      ASSERT_LE(now - deaf_since, 5s) << "seed " << seed << " at " << now.count();
    }
  }
}

/// Requests with ever new runs kept a far robot deaf.
TEST(LivingRuns, AFarRobotIsDisplacedWronglyOnce) {
  LivingRuns runs;
  Time silent_until = 0s;
  for (std::uint32_t second = 1; second <= 60; ++second) {
    const Time now = second * 1s;
    runs.told_alive(kRobot, kLiving, second, now);
    for (int i = 0; i < 3; ++i) runs.told(kRobot, kForged + 3 * second + i, now + i * 300ms);
    if (!runs.lives(kRobot, kLiving)) silent_until = now;
  }
  EXPECT_LE(silent_until, 5s);
}

/// One forged sign made all true ones old.
TEST(LivingRuns, WhatOthersTellGrowsWithTimeOnly) {
  LivingRuns runs;
  EXPECT_EQ(runs.credible(kRobot, kLiving, 1000, 10s), 1000u) << "nothing is known";
  runs.told_alive(kRobot, kLiving, 100, 10s);
  EXPECT_EQ(runs.credible(kRobot, kLiving, 115, 15s), 115u) << "it may have been late";
  EXPECT_EQ(runs.credible(kRobot, kLiving, 116, 15s), 115u);
  for (int i = 0; i < 5; ++i) runs.told_alive(kRobot, kLiving, runs.credible(kRobot, kLiving, 0x40000000, 20s), 20s);
  EXPECT_EQ(runs.life_sign(kRobot), 120u) << "however often it is told";
  runs.heard(kRobot, kLiving, 1, 30s);
  runs.said_alive(kRobot, kLiving, 121, 30s);
  EXPECT_EQ(runs.credible(kRobot, kLiving, 122, 30s), 122u);
  EXPECT_EQ(runs.credible(kRobot, kLiving, 200, 31s), 124u) << "of who is heard itself, little is to be told";
  EXPECT_EQ(runs.credible(kRobot, kForged, 200, 31s), 200u) << "of another run";
}

TEST(LivingRuns, AFirstSignThatWasTooGreatGivesWayToThoseThatGoOn) {
  LivingRuns runs;
  runs.told_alive(kRobot, kLiving, 0x40000000, 10s);
  std::uint32_t sign = 5;
  Time now = 11s;
  for (; now < 30s && !runs.goes_on_below(kRobot, kLiving, sign, now); now += 1s) ++sign;
  EXPECT_LE(now, 16s);
  EXPECT_EQ(runs.life_sign(kRobot), sign);
  EXPECT_EQ(runs.credible(kRobot, kLiving, 0x40000000, now), sign + 10);
}

TEST(LivingRuns, AGreatSignThatIsRaisedGivesWayToTheRobotItselfAlone) {
  LivingRuns runs;
  for (std::uint32_t second = 0; second < 8; ++second) {
    const Time now = 10s + second * 1s;
    runs.told_alive(kRobot, kLiving, 1000 + second, now);
    EXPECT_FALSE(runs.goes_on_below(kRobot, kLiving, 1 + second, now)) << second;
  }
  runs.heard(kRobot, kLiving, 1, 18s);
  for (std::uint32_t second = 8; second < 12; ++second) {
    const Time now = 10s + second * 1s;
    runs.told_alive(kRobot, kLiving, runs.credible(kRobot, kLiving, 1000 + second, now), now);
    EXPECT_TRUE(runs.said_alive(kRobot, kLiving, 1 + second, now));
  }
  EXPECT_EQ(runs.life_sign(kRobot), 12u);
}

/// Behind it lies a robot that has its news from here.
TEST(LivingRuns, ALateSignOfTheRobotItselfDoesNotReplaceWhatIsKnown) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 1, 10s);
  runs.said_alive(kRobot, kLiving, 100, 10s);
  for (std::uint32_t second = 1; second <= 9; ++second)
    runs.told_alive(kRobot, kLiving, 100 + second, 10s + second * 1s);
  runs.heard(kRobot, kLiving, 2, 19s);
  EXPECT_TRUE(runs.said_alive(kRobot, kLiving, 101, 19s));
  EXPECT_EQ(runs.life_sign(kRobot), 109u);
  EXPECT_EQ(runs.credible(kRobot, kLiving, 110, 20s), 110u);
}

TEST(LivingRuns, AreBoundedAndThoseHeardStay) {
  LivingRuns runs;
  runs.heard(kRobot, kLiving, 1, 10s);
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const MacAddress stranger = {0x06, 0, 0, 0, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
    runs.told(stranger, 1, 10s + i * 100us);
  }
  EXPECT_EQ(runs.size(), LivingRuns::kMostRobots);
  EXPECT_TRUE(runs.lives(kRobot, kLiving));
  runs.expire(100s);
  EXPECT_EQ(runs.size(), 0u);
}

/// A neighbour that is heard, and a liar who tells of another run of it.
struct Lied : Stage {
  Lied() : told(neighbor(0)), liar(neighbor(1)) {
    run_for(1s);
    forged = told;
    forged.boot_id[3] = 0xee;
    forged.sequence = 1000;
  }
  /// A packet of the robot told of arrives.
  bool hears() {
    const std::size_t before = team.received(0).size();
    say(told, data_for(self(), told, ++packet));
    run_for(1ms);
    return team.received(0).size() > before;
  }
  Host& told;
  Host& liar;
  Host forged;
  std::uint32_t packet = 0;
};

/// One such request made the live run a former one, here and wherever it was passed on, and its frames were dropped
/// for a minute.
TEST(LivingRuns, ARequestOfAnUnknownRunDoesNotDeafen) {
  Lied stage;
  ASSERT_TRUE(stage.hears());
  stage.forget();
  stage.say(stage.liar, request_for(make_host(9), stage.forged));
  EXPECT_TRUE(stage.hears());
  stage.run_for(100ms);
  EXPECT_TRUE(stage.requests().empty()) << "nor is it passed on";
  EXPECT_EQ(stage.team.presence(0).size(), 2u);
}

TEST(LivingRuns, AReplyAboutAnUnknownRunDoesNotDeafen) {
  Lied stage;
  stage.give_route(stage.liar, stage.forged);
  EXPECT_TRUE(stage.hears());
  EXPECT_EQ(stage.route(stage.told)->next_hop, stage.told.address);
}

/// It replaced the receiver of the live run, and with it what had arrived.
TEST(LivingRuns, DataOfAnUnknownRunDoesNotDeafen) {
  Lied stage;
  ASSERT_TRUE(stage.hears());
  stage.say(stage.liar, data_for(stage.self(), stage.forged, 1));
  stage.run_for(1ms);
  EXPECT_EQ(stage.team.received(0).size(), 1u);
  EXPECT_TRUE(stage.hears());
}

TEST(LivingRuns, ARequestThatNamesAnotherRunOfItsTransmitterIsNotBelieved) {
  Lied stage;
  stage.say(stage.told, request_for(make_host(9), stage.forged));
  EXPECT_TRUE(stage.hears());
}

TEST(LivingRuns, ARestartIsBelievedOnceTheFormerRunDoesNotAnswer) {
  Lied stage;
  Host former = stage.told;
  stage.restart(stage.told);
  EXPECT_EQ(stage.team.presence(0).back().second, "+" + stage.told.name);
  EXPECT_EQ(stage.team.presence(0).size(), 4u);
  stage.say(stage.told, request_for(make_host(9), stage.told));
  stage.say(former, request_for(make_host(9), former, 2));
  stage.run_for(1ms);
  EXPECT_EQ(stage.route(stage.told)->boot, stage.told.boot());
}

}  // namespace
}  // namespace adhoc_communication
