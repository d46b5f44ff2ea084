// A HubLink against the radio's end of it.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "link/hub_link.hpp"
#include "link/mac_address.hpp"
#include "radio/listening_socket.hpp"
#include "radio/port.hpp"

namespace {
std::function<void()> before_listen;
}

// In place of the C library's.
extern "C" int listen(int descriptor, int backlog) noexcept {
  if (before_listen) before_listen();
  return static_cast<int>(syscall(SYS_listen, descriptor, backlog));
}

namespace adhoc_communication {
namespace {

bool becomes_readable(int descriptor) {
  struct pollfd source {
    descriptor, POLLIN, 0
  };
  return poll(&source, 1, 5000) == 1;
}

class HubLinkTest : public ::testing::Test {
 protected:
  HubLinkTest() {
    char folder[] = "/tmp/hub_link_XXXXXX";
    folder_ = mkdtemp(folder);
  }
  ~HubLinkTest() override { rmdir(folder_.c_str()); }

  std::string path() const { return folder_ + "/hub"; }

  static std::unique_ptr<HubPort> accept(ListeningSocket& hub) {
    EXPECT_TRUE(becomes_readable(hub.descriptor()));
    return std::make_unique<HubPort>(hub.accept());
  }

  static Frame frame_to(const MacAddress& destination) {
    Frame frame;
    frame.destination = destination;
    frame.source = address_of_robot("bob");
    frame.bytes = {1, 2, 3};
    return frame;
  }

  template <typename Receiver>
  static std::vector<Frame> received(Receiver& receiver) {
    std::vector<Frame> frames;
    receiver.receive([&](const Frame& frame, Time) { frames.push_back(frame); });
    return frames;
  }

  std::string folder_;
};

TEST_F(HubLinkTest, NamesItselfAndCarriesFramesBothWays) {
  ListeningSocket hub(path());
  HubLink link(path(), std::nullopt, "alice");
  const auto port = accept(hub);
  EXPECT_EQ(port->receive_name(), "alice");

  const Frame sent = frame_to(kBroadcastAddress);
  link.send(sent);
  const auto heard = received(*port);
  ASSERT_EQ(heard.size(), 1u);
  EXPECT_EQ(heard[0].bytes, sent.bytes);
  EXPECT_EQ(heard[0].source, sent.source);

  port->send(frame_to(link.address()));
  EXPECT_EQ(received(link).size(), 1u);
  EXPECT_EQ(link.frames_not_sent(), 0u);
}

TEST_F(HubLinkTest, ManyFramesComeInOrderAndNotAllAtOnce) {
  constexpr std::uint8_t kFrames = Link::kMostAtOnce + 5;
  ListeningSocket hub(path());
  HubLink link(path(), std::nullopt, "alice");
  const auto port = accept(hub);
  for (std::uint8_t i = 0; i < kFrames; ++i) {
    Frame frame = frame_to(link.address());
    frame.bytes = {i};
    port->send(frame);
  }
  std::vector<Frame> heard = received(link);
  EXPECT_EQ(heard.size(), std::size_t{Link::kMostAtOnce});
  for (const Frame& frame : received(link)) heard.push_back(frame);
  ASSERT_EQ(heard.size(), std::size_t{kFrames});
  for (std::uint8_t i = 0; i < kFrames; ++i) EXPECT_EQ(heard[i].bytes, Bytes{i});
}

TEST_F(HubLinkTest, FramesBeforeTheEndOfTheRadioArrive) {
  ListeningSocket hub(path());
  HubLink link(path(), std::nullopt, "alice");
  auto port = accept(hub);
  EXPECT_EQ(port->receive_name(), "alice");
  port->send(frame_to(link.address()));
  port.reset();
  EXPECT_EQ(received(link).size(), 1u);
  EXPECT_FALSE(link.is_up());
}

TEST_F(HubLinkTest, IgnoresFramesForOthersAndItsOwn) {
  ListeningSocket hub(path());
  HubLink link(path(), std::nullopt, "alice");
  const auto port = accept(hub);
  port->send(frame_to(address_of_robot("carol")));
  Frame own = frame_to(kBroadcastAddress);
  own.source = link.address();
  port->send(own);
  EXPECT_TRUE(received(link).empty());
}

TEST_F(HubLinkTest, ConnectsAgainWhenTheRadioIsBack) {
  auto hub = std::make_unique<ListeningSocket>(path());
  HubLink link(path(), std::nullopt, "alice");
  hub.reset();
  EXPECT_TRUE(received(link).empty());
  EXPECT_FALSE(link.is_up());
  link.send(frame_to(kBroadcastAddress));  // lost and counted, nothing worse
  EXPECT_EQ(link.frames_not_sent(), 1u);
  link.tend();
  EXPECT_FALSE(link.is_up());
  hub = std::make_unique<ListeningSocket>(path());
  link.tend();
  EXPECT_TRUE(link.is_up());
  EXPECT_EQ(accept(*hub)->receive_name(), "alice");
}

TEST_F(HubLinkTest, AbsentRadioIsNamed) {
  try {
    HubLink link(path(), std::nullopt, "alice");
    FAIL();
  } catch (const LinkError& error) {
    EXPECT_NE(std::string(error.what()).find(path()), std::string::npos);
  }
}

TEST_F(HubLinkTest, SecondRadioOnTheSameSocketIsRefused) {
  ListeningSocket hub(path());
  EXPECT_THROW(ListeningSocket second(path()), std::runtime_error);
  HubLink link(path(), std::nullopt, "alice");  // the first one still listens
}

// Whoever waited for the socket's file to be there was refused now and then: it was there before anybody listened.
TEST_F(HubLinkTest, TheSocketOfTheRadioHasItsNameWhenItListens) {
  bool asked = false;
  before_listen = [&] {
    asked = true;
    EXPECT_NE(access(path().c_str(), F_OK), 0);
  };
  ListeningSocket hub(path());
  before_listen = nullptr;
  EXPECT_TRUE(asked);
  EXPECT_EQ(access(path().c_str(), F_OK), 0);
}

TEST_F(HubLinkTest, ASocketThatADeadRadioLeftIsReplacedAndNothingElse) {
  const std::string left = path() + ".left";
  {
    ListeningSocket dead(path());
    ASSERT_EQ(rename(path().c_str(), left.c_str()), 0);
  }
  ASSERT_EQ(rename(left.c_str(), path().c_str()), 0);
  { ListeningSocket hub(path()); }
  std::ofstream(path()) << "somebody's text";
  EXPECT_THROW(ListeningSocket hub(path()), std::runtime_error);
  std::string kept;
  std::getline(std::ifstream(path()), kept);
  EXPECT_EQ(kept, "somebody's text");
  unlink(path().c_str());
}

}  // namespace
}  // namespace adhoc_communication
