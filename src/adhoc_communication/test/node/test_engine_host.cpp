// The loop of the engine on links that behave badly.
#include <gtest/gtest.h>
#include <sys/eventfd.h>

#include <future>
#include <utility>

#include "link/file_descriptor.hpp"
#include "link/steady_now.hpp"
#include "node/engine_host.hpp"

namespace adhoc_communication {
namespace {

/// Always has more frames than one look takes; their arrivals go back and forth.
class FloodedLink : public Link {
 public:
  int descriptor() const override { return always_readable_.get(); }
  int receive(const FrameTaker& take) override {
    const Frame junk{kEverybody, {2, 0, 0, 0, 0, 7}, Bytes(100, 1)};
    for (int i = 0; i < kMostAtOnce; ++i) take(junk, steady_now() - std::chrono::milliseconds(i % 3));
    return kMostAtOnce;
  }
  using Link::send;
  void send(const Frame*, std::size_t) override {
    if (!sent_) beacon.set_value();
    sent_ = true;
  }
  void tend() override {}
  bool is_up() const override { return true; }
  MacAddress address() const override { return {2, 0, 0, 0, 0, 1}; }
  int mtu() const override { return 1500; }
  std::uint64_t frames_not_sent() const override { return 3; }

  std::promise<void> beacon;

 private:
  static constexpr MacAddress kEverybody = {0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
  FileDescriptor always_readable_{eventfd(1, EFD_NONBLOCK | EFD_CLOEXEC)};
  bool sent_ = false;
};

TEST(EngineHost, FloodHoldsUpNeitherTimersNorCommands) {
  EngineOptions options;
  options.robot_name = "alice";
  auto link = std::make_unique<FloodedLink>();
  std::future<void> beacon = link->beacon.get_future();
  EngineHost host(options, std::move(link), ReceiveFilter("alice", {}, {}, nullptr), {});
  ASSERT_EQ(beacon.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  const Snapshot snapshot = host.snapshot();
  EXPECT_GE(snapshot.statistics.frames_received, std::uint64_t{Link::kMostAtOnce});
  EXPECT_EQ(snapshot.statistics.frames_dropped.malformed, snapshot.statistics.frames_received);
  EXPECT_EQ(snapshot.frames_not_sent, 3u);
}

/// The engine takes the channel for shared only where the device keeps frames.
TEST(EngineHost, AsksTheLinkWhatItHasNotSent) {
  class AskedLink : public FloodedLink {
   public:
    explicit AskedLink(std::promise<void>& asked) : asked_(asked) {}
    void send(const Frame*, std::size_t) override { sent_ = true; }
    bool keeps_frames() const override {
      if (sent_ && !std::exchange(told_, true)) asked_.set_value();
      return true;
    }

   private:
    std::promise<void>& asked_;
    bool sent_ = false;
    mutable bool told_ = false;
  };
  EngineOptions options;
  options.robot_name = "alice";
  std::promise<void> asked;
  EngineHost host(options, std::make_unique<AskedLink>(asked), ReceiveFilter("alice", {}, {}, nullptr), {});
  EXPECT_EQ(asked.get_future().wait_for(std::chrono::seconds(30)), std::future_status::ready);
}

/// Becomes another one at its first look.
class ReplacedLink : public FloodedLink {
 public:
  void tend() override { replaced_ = true; }
  MacAddress address() const override { return {2, 0, 0, 0, 0, static_cast<std::uint8_t>(replaced_ ? 9 : 1)}; }
  int mtu() const override { return replaced_ ? 900 : 1500; }
  int receive(const FrameTaker&) override { return 0; }

 private:
  bool replaced_ = false;
};

TEST(EngineHost, BeginsAnewOnAnInterfaceThatHasChanged) {
  EngineOptions options;
  options.robot_name = "alice";
  std::promise<std::string> warned;
  HostCallbacks callbacks;
  callbacks.on_warning = [&](const std::string& text) { warned.set_value(text); };
  EngineHost host(options, std::make_unique<ReplacedLink>(), ReceiveFilter("alice", {}, {}, nullptr), callbacks);
  std::future<std::string> warning = warned.get_future();
  ASSERT_EQ(warning.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_EQ(warning.get(), "the interface has changed, so this robot begins anew as 02:00:00:00:00:09, MTU 900");
  EXPECT_EQ(host.snapshot().address, (MacAddress{2, 0, 0, 0, 0, 9}));
}

/// It was only said that the interface is down.
TEST(EngineHost, SaysWhyAnInterfaceThatIsBackCannotBeUsed) {
  class UselessLink : public FloodedLink {
   public:
    int receive(const FrameTaker&) override { return 0; }
    void tend() override { ++looks_; }
    bool is_up() const override { return looks_ == 0; }
    std::string trouble() const override { return looks_ < 2 ? "" : "it is a tunnel"; }

   private:
    int looks_ = 0;
  };
  EngineOptions options;
  options.robot_name = "alice";
  std::promise<std::vector<std::string>> told;
  std::vector<std::string> warnings;
  HostCallbacks callbacks;
  callbacks.on_warning = [&](const std::string& text) {
    warnings.push_back(text);
    if (warnings.size() == 2) told.set_value(warnings);
  };
  EngineHost host(options, std::make_unique<UselessLink>(), ReceiveFilter("alice", {}, {}, nullptr), callbacks);
  std::future<std::vector<std::string>> all = told.get_future();
  ASSERT_EQ(all.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_EQ(all.get(), (std::vector<std::string>{"the interface is down; waiting for its return",
                                                 "the interface is down; waiting for its return: it is a tunnel"}));
}

/// Whatever its kind, an exception ended the whole process without a word.
TEST(EngineHost, SaysWhatHasEndedIt) {
  class ThrowingLink : public ReplacedLink {
   public:
    int receive(const FrameTaker&) override { throw 7; }
  };
  EngineOptions options;
  options.robot_name = "alice";
  std::promise<std::string> failed;
  HostCallbacks callbacks;
  callbacks.on_warning = [](const std::string&) {};
  callbacks.on_failure = [&](const std::string& text) { failed.set_value(text); };
  EngineHost host(options, std::make_unique<ThrowingLink>(), ReceiveFilter("alice", {}, {}, nullptr), callbacks);
  std::future<std::string> failure = failed.get_future();
  ASSERT_EQ(failure.wait_for(std::chrono::seconds(30)), std::future_status::ready);
  EXPECT_EQ(failure.get(), "the engine has ended by an unknown exception");
  EXPECT_EQ(host.send({"bob", "topic", 'A', Bytes{1}}).reason, "the node is shutting down");
}

/// What waited for the engine when it ended waited for ever, and so did who stopped the services.
TEST(EngineHost, NobodyWaitsForAnEngineThatHasEnded) {
  /// Ends the engine once it is told to, while commands wait.
  class EndingLink : public ReplacedLink {
   public:
    EndingLink(std::promise<void>& looked, std::shared_future<void> ends) : looked_(looked), ends_(std::move(ends)) {}
    int receive(const FrameTaker&) override {
      if (!std::exchange(told_, true)) looked_.set_value();
      ends_.wait();
      throw std::runtime_error("the link is broken");
    }

   private:
    std::promise<void>& looked_;
    std::shared_future<void> ends_;
    bool told_ = false;
  };
  EngineOptions options;
  options.robot_name = "alice";
  std::promise<void> looked;
  std::promise<void> ends;
  HostCallbacks callbacks;
  callbacks.on_warning = [](const std::string&) {};
  EngineHost host(options, std::make_unique<EndingLink>(looked, ends.get_future().share()),
                  ReceiveFilter("alice", {}, {}, nullptr), callbacks);
  looked.get_future().wait();
  int told = 0;
  host.send({"bob", "topic", 'A', Bytes{1}}, [&](const Outcome& end) {
    ++told;
    EXPECT_EQ(end.reason, "the node is shutting down");
    throw 7;  // keeps nobody else from being told
  });
  const auto call = [](auto ask) { return std::async(std::launch::async, ask); };
  auto sent = call([&] { return host.send({"bob", "topic", 'A', Bytes{1}}).reason; });
  auto joined = call([&] { return host.join_group("mc_bob").reason; });
  auto asked = call([&]() -> std::string {
    try {
      host.neighbors();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  });
  ends.set_value();
  for (auto* end : {&sent, &joined, &asked}) EXPECT_EQ(end->get(), "the node is shutting down");
  host.stop();
  EXPECT_EQ(told, 1);
}

}  // namespace
}  // namespace adhoc_communication
