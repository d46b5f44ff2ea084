// A thread for calls that may wait for the ROS master.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace adhoc_communication {

/// roscpp asks the master with its locks held, so while that hangs, even to publish may wait.
class Errands {
 public:
  using Errand = std::function<void()>;

  /// Beyond `most` that wait, the oldest of them is dropped.
  explicit Errands(std::size_t most) : most_(most), thread_([this] { run(); }) {}
  /// Those that wait are dropped.
  ~Errands();

  /// Returns at once; they are run in order.
  void add(Errand errand);

 private:
  void run();
  void work();

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable added_;
  std::deque<Errand> waiting_;
  bool stopping_ = false;
  std::thread thread_;  ///< last, as it uses the others
};

}  // namespace adhoc_communication
