// Slow calls do not keep others waiting.
#include <gtest/gtest.h>

#include <future>

#include "node/service_pool.hpp"

namespace adhoc_communication {
namespace {

class Call : public ros::CallbackInterface {
 public:
  explicit Call(std::function<void()> action) : action_(std::move(action)) {}
  CallResult call() override {
    action_();
    return Success;
  }

 private:
  std::function<void()> action_;
};

constexpr auto kPatience = std::chrono::seconds(10);

TEST(ServicePool, QuickCallPassesSlowOnes) {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  std::promise<void> quick;
  ServicePool pool(8);
  for (int i = 0; i < 7; ++i) pool.addCallback(boost::make_shared<Call>([released] { released.wait(); }), 1);
  pool.addCallback(boost::make_shared<Call>([&quick] { quick.set_value(); }), 1);
  EXPECT_EQ(quick.get_future().wait_for(kPatience), std::future_status::ready);
  release.set_value();
}

TEST(ServicePool, CallsBeyondTheThreadsWaitTheirTurn) {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  std::promise<void> later;
  auto later_done = later.get_future();
  ServicePool pool(2);
  for (int i = 0; i < 2; ++i) pool.addCallback(boost::make_shared<Call>([released] { released.wait(); }), 1);
  pool.addCallback(boost::make_shared<Call>([&later] { later.set_value(); }), 1);
  EXPECT_EQ(later_done.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  release.set_value();
  EXPECT_EQ(later_done.wait_for(kPatience), std::future_status::ready);
}

TEST(ServicePool, RemovedCallsAreNotMade) {
  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  std::promise<void> last;
  bool removed_was_called = false;
  ServicePool pool(1);
  pool.addCallback(boost::make_shared<Call>([released] { released.wait(); }), 1);
  pool.addCallback(boost::make_shared<Call>([&removed_was_called] { removed_was_called = true; }), 2);
  pool.removeByID(2);
  pool.addCallback(boost::make_shared<Call>([&last] { last.set_value(); }), 1);
  release.set_value();
  EXPECT_EQ(last.get_future().wait_for(kPatience), std::future_status::ready);
  pool.stop();
  EXPECT_FALSE(removed_was_called);
}

}  // namespace
}  // namespace adhoc_communication
