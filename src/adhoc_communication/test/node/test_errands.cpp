// What may wait for the ROS master holds up nobody.
#include <gtest/gtest.h>

#include <future>
#include <vector>

#include "node/errands.hpp"

namespace adhoc_communication {
namespace {

constexpr auto kLongWait = std::chrono::seconds(10);

/// The engine stood still when a robot came while the master hung.
TEST(Errands, OneThatHangsHoldsUpNobodyAndTheOldestThatWaitAreDropped) {
  std::promise<void> begun, release, ended;
  std::vector<int> run;
  Errands errands(3);
  errands.add([&] {
    begun.set_value();
    release.get_future().wait();
  });
  ASSERT_EQ(begun.get_future().wait_for(kLongWait), std::future_status::ready);
  for (int i = 1; i <= 5; ++i) {
    errands.add([&run, &ended, i] {
      run.push_back(i);
      if (i == 5) ended.set_value();
    });
  }
  release.set_value();
  ASSERT_EQ(ended.get_future().wait_for(kLongWait), std::future_status::ready);
  EXPECT_EQ(run, (std::vector<int>{3, 4, 5}));
}

}  // namespace
}  // namespace adhoc_communication
