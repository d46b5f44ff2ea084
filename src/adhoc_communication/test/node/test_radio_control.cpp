// Commands of the radio daemon and its command line.
#include <gtest/gtest.h>

#include "radio/control.hpp"
#include "radio/options.hpp"

namespace adhoc_communication {
namespace {

RadioOptions parse(std::vector<std::string> words) {
  std::vector<char*> arguments;
  words.insert(words.begin(), "radio");
  for (auto& word : words) arguments.push_back(word.data());
  return parse_radio_options(static_cast<int>(arguments.size()), arguments.data());
}

class RadioControl : public ::testing::Test {
 protected:
  RadioControl() : medium_(MediumOptions(), 1), a_(medium_.add_node("a")), b_(medium_.add_node("b")) {}

  bool arrives() {
    Frame frame;
    frame.destination.fill(0xff);
    frame.source = {2, 0, 0, 0, 0, 1};
    frame.bytes.resize(100);
    now_ += std::chrono::seconds(1);
    medium_.transmit(a_, frame, now_);
    return !medium_.deliveries(now_ + std::chrono::milliseconds(100)).empty();
  }
  std::string carry_out(const std::string& line) { return adhoc_communication::carry_out(line, medium_, now_); }

  Medium medium_;
  Medium::Node a_, b_;
  Time now_{0};
};

TEST_F(RadioControl, RobotsWithoutPositionHearEachOther) { EXPECT_TRUE(arrives()); }

TEST_F(RadioControl, PositionAndRange) {
  EXPECT_EQ(carry_out("position a 0 0"), "");
  EXPECT_EQ(carry_out("position b 12 0"), "");
  EXPECT_FALSE(arrives());
  EXPECT_EQ(carry_out("range 15"), "");
  EXPECT_TRUE(arrives());
}

TEST_F(RadioControl, LossAndLink) {
  EXPECT_EQ(carry_out("loss 1"), "");
  EXPECT_FALSE(arrives());
  EXPECT_EQ(carry_out("link a b 0"), "");
  EXPECT_TRUE(arrives());
}

TEST_F(RadioControl, DownAndUp) {
  EXPECT_EQ(carry_out("down b"), "");
  EXPECT_FALSE(arrives());
  EXPECT_EQ(carry_out("up b"), "");
  EXPECT_TRUE(arrives());
}

TEST_F(RadioControl, PositionIsKeptForARobotThatComesLater) {
  EXPECT_EQ(carry_out("position c 1 2"), "");
  EXPECT_TRUE(medium_.find("c"));
}

TEST_F(RadioControl, WrongCommandsAreRefusedWhole) {
  for (const char* line : {"", "jump", "position a 1", "position a x 1", "position a 1 2 3", "loss 2", "loss -0.1",
                           "link a b", "range", "range -1", "down"}) {
    EXPECT_NE(carry_out(line), "") << line;
  }
  EXPECT_TRUE(arrives());
}

TEST_F(RadioControl, PositionsBeyondAllMeasureAreRefused) {
  EXPECT_NE(carry_out("position a 1e10 0"), "");
  EXPECT_NE(carry_out("position a 0 -1e300"), "");
}

TEST_F(RadioControl, WhatIsNoNameOfARobotIsRefused) {
  EXPECT_NE(carry_out("position c\"d 0 0").find("cannot be the name of a robot"), std::string::npos);
  EXPECT_NE(carry_out("down " + std::string(65, 'c')), "");
  EXPECT_EQ(medium_.node_count(), 2u);
}

TEST_F(RadioControl, RobotsWithoutEndAreRefusedAndTheRadioGoesOn) {
  for (int i = 0; i < 998; ++i) ASSERT_EQ(carry_out("position robot_" + std::to_string(i) + " 0 0"), "");
  EXPECT_NE(carry_out("position robot_998 0 0").find("takes no more"), std::string::npos);
  EXPECT_TRUE(arrives());
}

TEST(RadioControlByPathLoss, RangeIsRefusedBecauseItWouldDoNothing) {
  MediumOptions options;
  options.path_loss = PathLoss();
  Medium medium(options, 1);
  EXPECT_NE(carry_out("range 15", medium, Time{0}).find("path loss decides"), std::string::npos);
}

TEST(RadioControlStatistics, NameEveryCounter) {
  Medium medium(MediumOptions(), 1);
  medium.add_node("a");
  const std::string json = statistics_json(medium);
  for (const char* name :
       {"frames", "bytes", "delivered", "lost", "collided", "unheard", "discarded", "repeated", "air_time"}) {
    EXPECT_NE(json.find("\"" + std::string(name) + "\": 0"), std::string::npos) << name;
  }
}

TEST(RadioOptions, AreRead) {
  const RadioOptions options =
      parse({"--interface", "robot_0=air0", "--range", "5", "--loss", "0.1", "--bit-rate", "1e6", "--seed", "9",
             "--shared", "true", "--spatial-reuse", "true", "__name:=radio"});
  EXPECT_EQ(options.interfaces.at("robot_0"), "air0");
  EXPECT_DOUBLE_EQ(options.medium.range, 5.0);
  EXPECT_DOUBLE_EQ(options.medium.loss, 0.1);
  EXPECT_DOUBLE_EQ(options.medium.bit_rate, 1e6);
  EXPECT_EQ(options.seed, 9u);
  EXPECT_TRUE(options.medium.shared);
  EXPECT_TRUE(options.medium.spatial_reuse);
  EXPECT_FALSE(options.medium.path_loss);
}

TEST(RadioOptions, OfTheModelAreRead) {
  const RadioOptions options = parse({"--hub", "x", "--p-tx", "1", "--shadowing", "4", "--shadowing-distance", "2.5",
                                      "--contention", "true", "--capture", "6", "--rtf", "2"});
  ASSERT_TRUE(options.medium.path_loss);
  EXPECT_DOUBLE_EQ(options.medium.path_loss->p_tx, 1.0);
  EXPECT_DOUBLE_EQ(options.medium.path_loss->p_thres, -75.0);
  EXPECT_DOUBLE_EQ(options.medium.shadowing.deviation, 4.0);
  EXPECT_DOUBLE_EQ(options.medium.shadowing.distance, 2.5);
  EXPECT_TRUE(options.medium.contention);
  EXPECT_DOUBLE_EQ(options.medium.capture, 6.0);
  EXPECT_DOUBLE_EQ(options.rtf, 2.0);
  const RadioOptions all = parse({"--hub", "x", "--p-thres", "-80", "--l-0-model", "40", "--n-model", "2.5"});
  EXPECT_DOUBLE_EQ(all.medium.path_loss->p_thres, -80.0);
  EXPECT_DOUBLE_EQ(all.medium.path_loss->l_0_model, 40.0);
  EXPECT_DOUBLE_EQ(all.medium.path_loss->n_model, 2.5);
}

TEST(RadioOptions, OfTheRatesAreRead) {
  const RadioOptions options = parse({"--hub", "x", "--contention", "true", "--broadcast-rate", "6e6",
                                      "--unicast-rates", "true", "--unicast-retries", "7"});
  EXPECT_DOUBLE_EQ(options.medium.rates.broadcast, 6e6);
  ASSERT_FALSE(options.medium.rates.unicast.empty());
  EXPECT_DOUBLE_EQ(options.medium.rates.unicast.back().bit_rate, 54e6);
  EXPECT_EQ(options.medium.rates.unicast_retries, 7);
  EXPECT_TRUE(parse({"--hub", "x", "--unicast-rates", "false"}).medium.rates.unicast.empty());
}

TEST(RadioOptions, OfTheChannelAreRead) {
  const RadioOptions options =
      parse({"--hub", "x", "--burst-good", "0.4", "--burst-bad", "0.1", "--burst-loss", "0.5", "--delay", "0.3",
             "--jitter", "0.05", "--jitter-reorders", "true", "--interference-period", "10", "--interference", "2"});
  EXPECT_EQ(options.medium.bursts.good, 400ms);
  EXPECT_EQ(options.medium.bursts.bad, 100ms);
  EXPECT_DOUBLE_EQ(options.medium.bursts.loss, 0.5);
  EXPECT_EQ(options.medium.delay.fixed, 300ms);
  EXPECT_EQ(options.medium.delay.jitter, 50ms);
  EXPECT_TRUE(options.medium.delay.reorders);
  EXPECT_EQ(options.medium.interference.period, 10s);
  EXPECT_EQ(options.medium.interference.duration, 2s);
  const MediumOptions real = in_real_time(options.medium, 2.0);
  EXPECT_EQ(real.bursts.bad, 50ms);
  EXPECT_EQ(real.delay.fixed, 150ms);
  EXPECT_EQ(real.interference.period, 5s);
}

TEST(RadioOptions, WrongOnesAreRefused) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"--hub"},
                                                       {"--loss", "2", "--hub", "x"},
                                                       {"--interface", "air0"},
                                                       {"--interface", "=air0"},
                                                       {"--interface", "a b=air0"},
                                                       {"--what", "1"},
                                                       {"--interface", "a=x", "--interface", "a=y"},
                                                       {"--hub", "x", "--seed", "-1"},
                                                       {"--hub", "x", "--shared", "1"},
                                                       {"--hub", "x", "--range", "5", "--p-tx", "1"},
                                                       {"--hub", "x", "--shared", "true", "--contention", "true"},
                                                       {"--hub", "x", "--spatial-reuse", "true"},
                                                       {"--hub", "x", "--walls", "/nowhere/walls.pgm"},
                                                       {"--hub", "x", "--walls-resolution", "0.1"},
                                                       {"--hub", "x", "--walls-origin", "1"},
                                                       {"--hub", "x", "--rtf", "0"},
                                                       {"--hub", "x", "--n-model", "-1"},
                                                       {"--hub", "x", "--broadcast-rate", "-1"},
                                                       {"--hub", "x", "--unicast-rates", "54e6"},
                                                       {"--hub", "x", "--unicast-retries", "7"},
                                                       {"--hub", "x", "--burst-bad", "-1"},
                                                       {"--hub", "x", "--burst-loss", "2"},
                                                       {"--hub", "x", "--delay", "4000"},
                                                       {"--hub", "x", "--interference", "1"},
                                                       {"--hub", "x", "--shadowing-distance", "0"}};
  for (const auto& words : wrong) EXPECT_THROW(parse(words), std::invalid_argument);
}

TEST(RadioOptions, HelpShowsEveryDefaultAsItIs) {
  const std::string usage = kRadioUsage;
  const MediumOptions medium;
  const PathLoss path_loss;
  const std::vector<std::pair<std::string, double>> defaults = {{"--range", medium.range},
                                                                {"--p-tx", path_loss.p_tx},
                                                                {"--p-thres", path_loss.p_thres},
                                                                {"--l-0-model", path_loss.l_0_model},
                                                                {"--n-model", path_loss.n_model},
                                                                {"--walls-resolution", medium.walls.resolution},
                                                                {"--wall-attenuation", medium.wall_attenuation},
                                                                {"--shadowing", medium.shadowing.deviation},
                                                                {"--shadowing-distance", medium.shadowing.distance},
                                                                {"--loss", medium.loss},
                                                                {"--bit-rate", medium.bit_rate},
                                                                {"--broadcast-rate", medium.rates.broadcast},
                                                                {"--unicast-retries", medium.rates.unicast_retries},
                                                                {"--capture", medium.capture},
                                                                {"--rtf", RadioOptions().rtf}};
  for (const auto& [option, value] : defaults) {
    const auto place = usage.find("  " + option + " ");
    ASSERT_NE(place, std::string::npos) << option;
    EXPECT_DOUBLE_EQ(std::stod(usage.substr(place + 3 + option.size())), value) << option;
  }
}

TEST(RadioOptions, ASimulationAtTwiceTheSpeedHasFramesOfHalfTheLength) {
  MediumOptions medium;
  medium.bit_rate = 6e6;
  medium.rates.broadcast = 1e6;
  medium.rates.unicast = ofdm_rates();
  const MediumOptions real = in_real_time(medium, 2.0);
  EXPECT_DOUBLE_EQ(real.bit_rate, 12e6);
  EXPECT_EQ(2 * real.frame_overhead, medium.frame_overhead);
  EXPECT_EQ(2 * real.slot, medium.slot);
  EXPECT_DOUBLE_EQ(real.rates.broadcast, 2e6);
  EXPECT_DOUBLE_EQ(real.rates.unicast.back().bit_rate, 108e6);
  EXPECT_EQ(2 * real.rates.acknowledgment, medium.rates.acknowledgment);
  EXPECT_DOUBLE_EQ(in_real_time(medium, 0.5).bit_rate, 3e6);
}

}  // namespace
}  // namespace adhoc_communication
