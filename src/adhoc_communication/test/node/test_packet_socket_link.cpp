// Raw sockets on a cable of their own. Skipped where the machine grants no network namespace.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/wireless.h>
#include <net/if_arp.h>
#include <poll.h>
#include <sched.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdlib>

#include "link/interface_kind.hpp"
#include "link/packet_socket_link.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kTrial = 1;  // octets
constexpr MacAddress kAll = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff};

class PacketSocketLinkTest : public ::testing::Test {
 protected:
  void SetUp() override {
    home_ = FileDescriptor(open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC));
    if (!home_.is_open() || unshare(CLONE_NEWNET) != 0) GTEST_SKIP() << "no network namespace is granted here";
    away_ = true;
    lay_cable();
  }
  void TearDown() override {
    if (away_) {
      ASSERT_EQ(setns(home_.get(), CLONE_NEWNET), 0);
    }
  }

  static void run(const std::string& command) { ASSERT_EQ(std::system(command.c_str()), 0) << command; }
  static void lay_cable() {
    run("ip link add near0 type veth peer name far0 && ip link set near0 up && ip link set far0 up");
  }

  static std::vector<Frame> frames(const PacketSocketLink& from, const MacAddress& to, std::uint8_t count) {
    std::vector<Frame> all;
    for (std::uint8_t i = 0; i < count; ++i) all.push_back({to, from.address(), Bytes(100, i)});
    return all;
  }
  static bool becomes_readable(const PacketSocketLink& link, int milliseconds) {
    struct pollfd source {
      link.descriptor(), POLLIN, 0
    };
    return poll(&source, 1, milliseconds) == 1;
  }
  /// So many frames, but for those that tried the cable.
  static std::vector<Frame> received(PacketSocketLink& link, std::size_t count) {
    std::vector<Frame> all;
    while (all.size() < count && becomes_readable(link, 10'000)) {
      link.receive([&](const Frame& frame, Time) {
        if (frame.bytes.size() != kTrial) all.push_back(frame);
      });
    }
    return all;
  }
  /// A cable carries nothing for some time after its ends are up.
  static void wait_for_cable(PacketSocketLink& from, PacketSocketLink& to) {
    bool heard = false;
    for (int i = 0; i < 1000 && !heard; ++i) {
      from.send(Frame{kAll, from.address(), Bytes(kTrial)});
      if (becomes_readable(to, 10)) to.receive([&](const Frame&, Time) { heard = true; });
    }
    ASSERT_TRUE(heard);
  }
  static void send(PacketSocketLink& link, const std::vector<Frame>& all) { link.send(all.data(), all.size()); }

 private:
  FileDescriptor home_;
  bool away_ = false;
};

TEST_F(PacketSocketLinkTest, FramesOfSeveralBatchesPassInOrder) {
  PacketSocketLink near("near0", std::nullopt, "near"), far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
  const std::vector<Frame> sent = frames(near, far.address(), 3 * Link::kMostAtOnce);
  send(near, sent);
  const std::vector<Frame> heard = received(far, sent.size());
  ASSERT_EQ(heard.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(heard[i].bytes, sent[i].bytes);
  EXPECT_EQ(near.frames_not_sent(), 0u);
}

TEST_F(PacketSocketLinkTest, FramesForOthersAreReadAndIgnored) {
  PacketSocketLink near("near0", std::nullopt, "near"), far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
  send(near, frames(near, {2, 0, 0, 0, 0, 9}, 3));
  send(near, frames(near, kAll, 2));
  const std::vector<Frame> heard = received(far, 2);
  ASSERT_EQ(heard.size(), 2u);
  for (const Frame& frame : heard) EXPECT_EQ(frame.destination, kAll);
}

TEST_F(PacketSocketLinkTest, FrameTooLargeKeepsNoneOfTheOthersBack) {
  PacketSocketLink near("near0", std::nullopt, "near"), far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
  std::vector<Frame> sent = frames(near, kAll, 9);
  sent[4].bytes.resize(9000);
  send(near, sent);
  EXPECT_EQ(received(far, 8).size(), 8u);
  EXPECT_EQ(near.frames_not_sent(), 1u);
  EXPECT_TRUE(near.is_up());
}

/// A channel that is too slow for what is sent; its queue is the kernel's here, a driver's on a robot.
TEST_F(PacketSocketLinkTest, WhatHasNotLeftTheDeviceIsKnown) {
  PacketSocketLink near("near0", std::nullopt, "near"), far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
  int kept = 0;
  for (int i = 0; i < 100; ++i) {
    send(near, frames(near, kAll, 1));
    kept += near.keeps_frames();
  }
  EXPECT_LT(kept, 10) << "a cable takes all at once";
  if (std::system("tc qdisc add dev near0 root tbf rate 100kbit burst 1kb latency 9s 2> /dev/null") != 0) {
    GTEST_SKIP() << "no slow queue is granted here";
  }
  send(near, frames(near, kAll, 20));
  EXPECT_TRUE(near.keeps_frames());
  EXPECT_EQ(received(far, 120).size(), 120u);
  EXPECT_FALSE(near.keeps_frames());
}

TEST_F(PacketSocketLinkTest, FramesWhileTheInterfaceIsDownAreCounted) {
  PacketSocketLink near("near0", std::nullopt, "near"), far("far0", std::nullopt, "far");
  run("ip link set near0 down");
  send(near, frames(near, kAll, 5));
  EXPECT_FALSE(near.is_up());
  EXPECT_EQ(near.frames_not_sent(), 5u);
  run("ip link set near0 up");
  near.tend();
  EXPECT_TRUE(near.is_up());
  wait_for_cable(near, far);
}

TEST_F(PacketSocketLinkTest, InterfaceThatIsMadeAnewIsFoundAgain) {
  PacketSocketLink near("near0", std::nullopt, "near");
  run("ip link delete near0");
  send(near, frames(near, kAll, 5));
  near.tend();
  EXPECT_FALSE(near.is_up());
  EXPECT_EQ(near.frames_not_sent(), 5u);
  lay_cable();
  near.tend();
  EXPECT_TRUE(near.is_up());
  PacketSocketLink far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
}

TEST_F(PacketSocketLinkTest, AnotherAddressAndMtuAreNoticed) {
  PacketSocketLink near("near0", std::nullopt, "near");
  const MacAddress given = {2, 0, 0, 0, 0, 5};
  PacketSocketLink fixed("far0", given, "far");
  run("ip link set near0 address 02:00:00:00:07:07 mtu 1200");
  run("ip link set far0 address 02:00:00:00:08:08");
  near.tend();
  fixed.tend();
  EXPECT_EQ(near.address(), (MacAddress{2, 0, 0, 0, 7, 7}));
  EXPECT_EQ(near.mtu(), 1200);
  EXPECT_EQ(fixed.address(), given) << "the one that was asked for stays";
}

TEST_F(PacketSocketLinkTest, FramesThatFindNoRoomAreCounted) {
  PacketSocketLink near("near0", std::nullopt, "near"), far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
  far.tend();
  EXPECT_EQ(far.frames_missed(), 0u);
  for (int i = 0; i < 200; ++i) {
    std::vector<Frame> many = frames(near, kAll, 64);
    for (Frame& frame : many) frame.bytes.resize(1400);
    send(near, many);
  }
  far.tend();
  EXPECT_GT(far.frames_missed(), 0u);
}

/// SO_PRIORITY of the packet sockets of this process, sorted.
std::vector<int> priorities() {
  std::vector<int> found;
  for (int descriptor = 0; descriptor < 256; ++descriptor) {
    int domain = 0;
    socklen_t size = sizeof domain;
    if (getsockopt(descriptor, SOL_SOCKET, SO_DOMAIN, &domain, &size) != 0 || domain != AF_PACKET) continue;
    int priority = -1;
    size = sizeof priority;
    getsockopt(descriptor, SOL_SOCKET, SO_PRIORITY, &priority, &size);
    found.push_back(priority);
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST_F(PacketSocketLinkTest, EachAccessCategoryHasASocketOfItsPriority) {
  ASSERT_TRUE(priorities().empty());
  PacketSocketLink near("near0", std::nullopt, "near");
  EXPECT_EQ(priorities(), (std::vector<int>{0, 260, 262}));
  PacketSocketLink far("far0", std::nullopt, "far");
  wait_for_cable(near, far);
  std::vector<Frame> sent = frames(near, far.address(), 9);
  for (const std::size_t voice : {0, 3, 4, 8}) sent[voice].category = AccessCategory::kVoice;
  for (const std::size_t video : {1, 5}) sent[video].category = AccessCategory::kVideo;
  send(near, sent);
  const std::vector<Frame> heard = received(far, sent.size());
  ASSERT_EQ(heard.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) EXPECT_EQ(heard[i].bytes, sent[i].bytes) << "a cable has one queue";
  EXPECT_EQ(near.frames_not_sent(), 0u);
}

TEST_F(PacketSocketLinkTest, TunnelsAreRefused) {
  run("ip link add tunnel0 type ip6tnl local ::1 remote ::2 2>/dev/null || ip tuntap add dev tunnel0 mode tun");
  try {
    PacketSocketLink link("tunnel0", std::nullopt, "near");
    FAIL() << "it was taken";
  } catch (const LinkError& error) {
    EXPECT_NE(std::string(error.what()).find("'tunnel0' carries no Ethernet frames"), std::string::npos)
        << error.what();
  }
}

std::string refusal_to_open(const std::string& interface) {
  try {
    PacketSocketLink link(interface, std::nullopt, "near");
  } catch (const LinkError& error) {
    return error.what();
  }
  return "";
}

/// They were taken without a word, and deaf.
TEST_F(PacketSocketLinkTest, PortsOfABridgeAreRefused) {
  PacketSocketLink near("near0", std::nullopt, "near");
  if (std::system("ip link add br0 type bridge 2> /dev/null") != 0) GTEST_SKIP() << "no bridge is granted here";
  run("ip link set near0 master br0");
  const std::string why = "interface 'near0' is a port of bridge br0, which takes all that it hears: use br0";
  EXPECT_EQ(refusal_to_open("near0"), why);
  EXPECT_EQ(refusal_to_open("br0"), "");
  near.tend();
  EXPECT_FALSE(near.is_up());
  EXPECT_EQ(near.trouble(), why);
  run("ip link set near0 nomaster");
  near.tend();
  EXPECT_TRUE(near.is_up());
  EXPECT_EQ(near.trouble(), "");
}

TEST_F(PacketSocketLinkTest, InterfaceThatIsMadeAnewAndOfNoUseSaysWhy) {
  PacketSocketLink near("near0", std::nullopt, "near");
  run("ip link delete near0");
  near.tend();
  EXPECT_EQ(near.trouble(), "");
  run("ip link add near0 type ip6tnl local ::1 remote ::2 2>/dev/null || ip tuntap add dev near0 mode tun");
  near.tend();
  EXPECT_FALSE(near.is_up());
  EXPECT_NE(near.trouble().find("'near0' carries no Ethernet frames"), std::string::npos) << near.trouble();
  run("ip link delete near0");
  lay_cable();
  near.tend();
  EXPECT_TRUE(near.is_up());
  EXPECT_EQ(near.trouble(), "");
}

TEST(InterfaceKind, PortsAreOfUseWhereTheyAreHeardBesideTheirMaster) {
  const auto is_refused = [](const char* kind) {
    return objection("wlan0", {ARPHRD_ETHER, std::nullopt, {kind, "m0"}}).has_value();
  };
  for (const char* deaf : {"bridge", "bond", "team"}) EXPECT_TRUE(is_refused(deaf)) << deaf;
  for (const char* hears : {"", "batadv", "vrf"}) EXPECT_FALSE(is_refused(hears)) << hears;
}

TEST(InterfaceKind, OnlyThoseOverWhichRobotsHearEachOther) {
  const auto said = [](int hardware, std::optional<unsigned> mode) {
    return objection("wlan0", {hardware, mode}).value_or("");
  };
  for (const std::optional<unsigned> mode :
       {std::optional<unsigned>(), {IW_MODE_ADHOC}, {IW_MODE_MESH}, {IW_MODE_AUTO}}) {
    EXPECT_EQ(said(ARPHRD_ETHER, mode), "");
  }
  EXPECT_EQ(said(ARPHRD_LOOPBACK, std::nullopt), "");
  EXPECT_NE(said(ARPHRD_ETHER, IW_MODE_INFRA).find("'wlan0' is a station of an access point"), std::string::npos);
  EXPECT_NE(said(ARPHRD_ETHER, IW_MODE_MASTER).find("'wlan0' is an access point"), std::string::npos);
  EXPECT_NE(said(ARPHRD_IEEE80211_RADIOTAP, IW_MODE_MONITOR).find("carries no Ethernet"), std::string::npos);
  EXPECT_NE(said(ARPHRD_ETHER, IW_MODE_MONITOR).find("monitor"), std::string::npos);
  EXPECT_NE(said(ARPHRD_PPP, std::nullopt).find("hardware type 512"), std::string::npos);
}

}  // namespace
}  // namespace adhoc_communication
