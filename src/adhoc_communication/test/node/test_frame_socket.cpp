// Frames by the batch, through sockets of the system.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>

#include "link/file_descriptor.hpp"
#include "link/frame_socket.hpp"
#include "link/steady_now.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kLargest = 2000;
constexpr std::size_t kAtOnce = 8;

struct Pair {
  explicit Pair(int type) {
    int ends[2] = {-1, -1};
    EXPECT_EQ(socketpair(AF_UNIX, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends), 0);
    near = FileDescriptor(ends[0]);
    far = FileDescriptor(ends[1]);
  }
  FileDescriptor near, far;
};

Frame frame_with(std::size_t octets, std::uint8_t content) {
  return {{2, 0, 0, 0, 0, 1}, {2, 0, 0, 0, 0, 2}, Bytes(octets, content)};
}

std::vector<Frame> read_all(int descriptor) {
  ReceiveBatch batch(kLargest, kAtOnce);
  std::vector<Frame> frames;
  while (const std::size_t count = batch.fill(descriptor)) {
    EXPECT_LE(count, kAtOnce);
    for (std::size_t i = 0; i < count; ++i) {
      auto next = from_wire(batch.octets(i), batch.size(i));
      EXPECT_TRUE(next);
      if (next) frames.push_back(*next);
    }
  }
  EXPECT_EQ(errno, EAGAIN);
  return frames;
}

TEST(FrameSocket, MoreFramesThanOneCallTakesPassInOrder) {
  const Pair pair(SOCK_SEQPACKET);
  std::vector<Frame> sent;
  for (std::size_t i = 0; i < SendBatch::kMostAtOnce + 9; ++i)
    sent.push_back(frame_with(i, static_cast<std::uint8_t>(i)));
  SendBatch batch;
  const SendOutcome outcome = batch.send(pair.near.get(), sent.data(), sent.size());
  EXPECT_EQ(outcome.not_sent, 0u);
  EXPECT_EQ(outcome.error, 0);
  const std::vector<Frame> heard = read_all(pair.far.get());
  ASSERT_EQ(heard.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(heard[i].destination, sent[i].destination);
    EXPECT_EQ(heard[i].source, sent[i].source);
    EXPECT_EQ(heard[i].bytes, sent[i].bytes);
  }
}

TEST(FrameSocket, RefusedFrameKeepsNoneOfTheOthersBack) {
  const Pair pair(SOCK_DGRAM);
  const std::vector<Frame> sent = {frame_with(100, 1), frame_with(10'000'000, 2), frame_with(100, 3),
                                   frame_with(10'000'000, 4)};
  SendBatch batch;
  const SendOutcome outcome = batch.send(pair.near.get(), sent.data(), sent.size());
  EXPECT_EQ(outcome.not_sent, 2u);
  EXPECT_EQ(outcome.error, EMSGSIZE);
  const std::vector<Frame> heard = read_all(pair.far.get());
  ASSERT_EQ(heard.size(), 2u);
  EXPECT_EQ(heard[0].bytes[0], 1);
  EXPECT_EQ(heard[1].bytes[0], 3);
}

TEST(FrameSocket, WhatAFullSocketDoesNotTakeIsCounted) {
  const Pair pair(SOCK_SEQPACKET);
  const std::vector<Frame> sent(5000, frame_with(1500, 1));
  SendBatch batch;
  const SendOutcome outcome = batch.send(pair.near.get(), sent.data(), sent.size());
  EXPECT_GT(outcome.not_sent, 0u);
  EXPECT_EQ(outcome.error, EAGAIN);
  EXPECT_EQ(read_all(pair.far.get()).size() + outcome.not_sent, sent.size());
}

TEST(FrameSocket, ClosedSocketRefusesAll) {
  Pair pair(SOCK_SEQPACKET);
  pair.far.reset();
  const std::vector<Frame> sent(3, frame_with(10, 1));
  SendBatch batch;
  const SendOutcome outcome = batch.send(pair.near.get(), sent.data(), sent.size());
  EXPECT_EQ(outcome.not_sent, 3u);
  EXPECT_EQ(outcome.error, EPIPE);
}

/// A datagram socket of lo that the kernel stamps arrivals on.
struct Stamped {
  Stamped() {
    struct sockaddr_in local {};
    local.sin_family = AF_INET;
    local.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int yes = 1;
    EXPECT_EQ(setsockopt(socket.get(), SOL_SOCKET, SO_TIMESTAMPNS, &yes, sizeof yes), 0);
    EXPECT_EQ(bind(socket.get(), reinterpret_cast<struct sockaddr*>(&local), sizeof local), 0);
    socklen_t size = sizeof local;
    EXPECT_EQ(getsockname(socket.get(), reinterpret_cast<struct sockaddr*>(&local), &size), 0);
    EXPECT_EQ(connect(socket.get(), reinterpret_cast<struct sockaddr*>(&local), sizeof local), 0);  // to itself
  }
  FileDescriptor socket{::socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)};
};

/// Sends a frame, reads it 2 ms after it came, and says whether it is known to have come before those.
bool stamped_on_arrival(int descriptor) {
  SendBatch sending;
  const Frame sent = frame_with(10, 1);
  EXPECT_EQ(sending.send(descriptor, &sent, 1).not_sent, 0u);
  struct pollfd source {
    descriptor, POLLIN, 0
  };
  EXPECT_EQ(poll(&source, 1, 5000), 1);
  const Time there = steady_now();
  while (steady_now() < there + std::chrono::milliseconds(2)) continue;
  ReceiveBatch batch(kLargest, kAtOnce);
  EXPECT_EQ(batch.fill(descriptor), 1u);
  return batch.arrived(0) < there + std::chrono::milliseconds(1);
}

TEST(FrameSocket, ArrivalIsWhenTheFrameCameNotWhenItIsRead) {
  const Stamped stamped;
  bool early = false;  // the kernel begins to stamp some time after it is asked to
  for (const Time end = steady_now() + std::chrono::seconds(30); !early && steady_now() < end;) {
    early = stamped_on_arrival(stamped.socket.get());
  }
  EXPECT_TRUE(early);
}

TEST(FrameSocket, WithoutStampsArrivalIsTheReading) {
  const Pair pair(SOCK_SEQPACKET);
  SendBatch sending;
  const Frame sent = frame_with(10, 1);
  ASSERT_EQ(sending.send(pair.near.get(), &sent, 1).not_sent, 0u);
  const Time before = steady_now();
  ReceiveBatch batch(kLargest, kAtOnce);
  ASSERT_EQ(batch.fill(pair.far.get()), 1u);
  EXPECT_GE(batch.arrived(0), before);
  EXPECT_LE(batch.arrived(0), steady_now());
}

}  // namespace
}  // namespace adhoc_communication
