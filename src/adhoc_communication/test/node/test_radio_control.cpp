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

TEST(RadioOptions, AreRead) {
  const RadioOptions options = parse({"--interface", "robot_0=air0", "--range", "5", "--loss", "0.1", "--bit-rate",
                                      "1e6", "--seed", "9", "--shared", "true", "__name:=radio"});
  EXPECT_EQ(options.interfaces.at("robot_0"), "air0");
  EXPECT_DOUBLE_EQ(options.range, 5.0);
  EXPECT_DOUBLE_EQ(options.loss, 0.1);
  EXPECT_DOUBLE_EQ(options.bit_rate, 1e6);
  EXPECT_EQ(options.seed, 9u);
  EXPECT_TRUE(options.shared);
}

TEST(RadioOptions, WrongOnesAreRefused) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"--hub"},
                                                       {"--loss", "2", "--hub", "x"},
                                                       {"--interface", "air0"},
                                                       {"--interface", "=air0"},
                                                       {"--what", "1"},
                                                       {"--interface", "a=x", "--interface", "a=y"},
                                                       {"--hub", "x", "--seed", "-1"},
                                                       {"--hub", "x", "--shared", "1"}};
  for (const auto& words : wrong) EXPECT_THROW(parse(words), std::invalid_argument);
}

}  // namespace
}  // namespace adhoc_communication
