// The radio daemon at work: the medium in real time between hub clients.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "link/hub_link.hpp"
#include "link/mac_address.hpp"
#include "radio/radio.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kOctets = 1000;

class RadioTest : public ::testing::Test {
 protected:
  RadioTest() {
    char folder[] = "/tmp/radio_XXXXXX";
    folder_ = mkdtemp(folder);
    options_.hub = folder_ + "/hub";
    options_.control = folder_ + "/control";
  }
  ~RadioTest() override {
    eventfd_write(stop_.get(), 1);
    if (thread_.joinable()) thread_.join();
    radio_.reset();
    rmdir(folder_.c_str());
  }

  void start() {
    radio_ = std::make_unique<Radio>(options_);
    thread_ = std::thread([this] { radio_->run(stop_.get()); });
    alice_ = std::make_unique<HubLink>(options_.hub, std::nullopt, "alice");
    bob_ = std::make_unique<HubLink>(options_.hub, std::nullopt, "bob");
  }

  /// Commands, answered with the statistics so that they are known to have been carried out.
  std::string command(const std::string& lines) const {
    const FileDescriptor socket(::socket(AF_UNIX, SOCK_SEQPACKET, 0));
    struct sockaddr_un address {};
    address.sun_family = AF_UNIX;
    options_.control.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(connect(socket.get(), reinterpret_cast<struct sockaddr*>(&address), sizeof address), 0);
    const std::string request = lines + "\nstatistics\n";
    EXPECT_EQ(::send(socket.get(), request.data(), request.size(), 0), static_cast<ssize_t>(request.size()));
    std::string answer(65536, '\0');
    answer.resize(static_cast<std::size_t>(std::max<ssize_t>(0, recv(socket.get(), answer.data(), answer.size(), 0))));
    return answer;
  }

  static Frame frame_from(const HubLink& link) {
    Frame frame;
    frame.destination = kBroadcastAddress;
    frame.source = link.address();
    frame.bytes.resize(kOctets);
    return frame;
  }

  static bool hears(HubLink& link, int milliseconds) {
    struct pollfd source {
      link.descriptor(), POLLIN, 0
    };
    bool heard = false;
    if (poll(&source, 1, milliseconds) == 1) link.receive([&](const Frame&, Time) { heard = true; });
    return heard;
  }

  void expect_arrival(const std::string& positions) {
    command(positions);
    alice_->send(frame_from(*alice_));
    ++frames_sent_;
    EXPECT_TRUE(hears(*bob_, 10'000)) << positions;
  }

  void expect_loss(const std::string& positions) {
    command(positions);
    alice_->send(frame_from(*alice_));
    const std::string carried = "\"frames\": " + std::to_string(++frames_sent_) + ",";
    for (const auto give_up = Clock::now() + 10s; command("").find(carried) == std::string::npos;) {
      ASSERT_LT(Clock::now(), give_up) << "the radio did not carry the frame";
    }
    EXPECT_FALSE(hears(*bob_, 100)) << positions;
  }

  std::string folder_;
  RadioOptions options_;
  FileDescriptor stop_{eventfd(0, EFD_NONBLOCK)};
  std::unique_ptr<Radio> radio_;
  std::thread thread_;
  std::unique_ptr<HubLink> alice_, bob_;
  int frames_sent_ = 0;
};

TEST_F(RadioTest, PathLossDecidesWhatArrives) {
  options_.medium.path_loss = PathLoss();
  start();
  expect_arrival("position alice 0 0\nposition bob 26 0");
  expect_loss("position bob 27 0");
  expect_arrival("position bob 26 0");
}

TEST_F(RadioTest, WallsOfAnImageStopFrames) {
  const std::string image = folder_ + "/walls.pgm";
  std::ofstream(image, std::ios::binary) << "P5 3 1 255\n\xff" << '\0' << "\xff";
  std::vector<std::string> words = {"radio",
                                    "--hub",
                                    options_.hub,
                                    "--control",
                                    options_.control,
                                    "--walls",
                                    image,
                                    "--walls-resolution",
                                    "2",
                                    "--walls-origin",
                                    "0,-1",
                                    "--range",
                                    "10",
                                    "--wall-attenuation",
                                    "20"};
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  options_ = parse_radio_options(static_cast<int>(arguments.size()), arguments.data());
  unlink(image.c_str());
  start();
  expect_loss("position alice 1 0\nposition bob 5 0");  // 20 dB: 10 m become 3.2 m
  expect_arrival("position alice -3 0\nposition bob 1 0");
}

TEST_F(RadioTest, ARobotWithoutAProperNameIsNotHeardAndTheRadioGoesOn) {
  start();
  HubLink nobody(options_.hub, std::nullopt, "no\"body\n");
  EXPECT_EQ(command("").find("body"), std::string::npos) << command("");
  alice_->send(frame_from(*alice_));
  EXPECT_TRUE(hears(*bob_, 10'000));
}

TEST_F(RadioTest, FramesTakeTheirAirTimeByTheClock) {
  options_.medium.bit_rate = 4e4;  // 200 ms a frame, 100 ms in a simulation at twice the speed
  options_.rtf = 2.0;
  start();
  const auto begin = Clock::now();
  alice_->send(frame_from(*alice_));
  ASSERT_TRUE(hears(*bob_, 10'000));
  EXPECT_GE(Clock::now() - begin, 100ms);
  EXPECT_NE(command("").find("\"air_time\": 0.100025"), std::string::npos) << command("");
}

TEST_F(RadioTest, ContendersTakeTurnsInRealTime) {
  options_.medium.contention = true;
  options_.medium.bit_rate = 1e6;
  start();
  HubLink carol(options_.hub, std::nullopt, "carol");
  for (int i = 0; i < 5; ++i) {
    alice_->send(frame_from(*alice_));
    ASSERT_TRUE(hears(carol, 10'000));
    carol.send(frame_from(carol));
    ASSERT_TRUE(hears(*alice_, 10'000));
  }
  const std::string statistics = command("");
  EXPECT_NE(statistics.find("\"frames\": 10,"), std::string::npos) << statistics;
  EXPECT_NE(statistics.find("\"collided\": 0,"), std::string::npos) << statistics;
}

}  // namespace
}  // namespace adhoc_communication
