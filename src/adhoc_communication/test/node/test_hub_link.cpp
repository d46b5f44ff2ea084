// A HubLink against the radio's end of it.
#include <gtest/gtest.h>
#include <poll.h>

#include <cstdlib>

#include "link/hub_link.hpp"
#include "link/mac_address.hpp"
#include "radio/listening_socket.hpp"
#include "radio/port.hpp"

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

  std::string folder_;
};

TEST_F(HubLinkTest, NamesItselfAndCarriesFramesBothWays) {
  ListeningSocket hub(path());
  HubLink link(path(), std::nullopt, "alice");
  const auto port = accept(hub);
  EXPECT_EQ(port->receive_name(), "alice");

  const Frame sent = frame_to(kBroadcastAddress);
  link.send(sent);
  const auto heard = port->receive();
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->bytes, sent.bytes);
  EXPECT_EQ(heard->source, sent.source);

  port->send(frame_to(link.address()));
  EXPECT_TRUE(link.receive());
}

TEST_F(HubLinkTest, IgnoresFramesForOthersAndItsOwn) {
  ListeningSocket hub(path());
  HubLink link(path(), std::nullopt, "alice");
  const auto port = accept(hub);
  port->send(frame_to(address_of_robot("carol")));
  Frame own = frame_to(kBroadcastAddress);
  own.source = link.address();
  port->send(own);
  EXPECT_FALSE(link.receive());
}

TEST_F(HubLinkTest, ConnectsAgainWhenTheRadioIsBack) {
  auto hub = std::make_unique<ListeningSocket>(path());
  HubLink link(path(), std::nullopt, "alice");
  hub.reset();
  EXPECT_FALSE(link.receive());
  EXPECT_FALSE(link.is_up());
  link.send(frame_to(kBroadcastAddress));  // lost, nothing worse
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

}  // namespace
}  // namespace adhoc_communication
