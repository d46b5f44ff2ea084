// Threads for service calls: a callback queue whose callbacks never wait for one another.
#pragma once

#include <ros/callback_queue_interface.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <vector>

namespace adhoc_communication {

/// A thread is added whenever a call arrives and all threads are busy, up to `max_threads`; then calls queue up. Unlike
/// ros::AsyncSpinner, whose threads wake ten times a second each, idle threads here cost nothing.
class ServicePool : public ros::CallbackQueueInterface {
 public:
  explicit ServicePool(std::size_t max_threads) : max_threads_(max_threads) {}
  ~ServicePool() override { stop(); }

  void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) override;
  void removeByID(std::uint64_t owner_id) override;

  /// Waits for the calls under way; the queued ones are dropped.
  void stop();

 private:
  struct Call {
    ros::CallbackInterfacePtr callback;
    std::uint64_t owner_id;
  };

  void work();

  const std::size_t max_threads_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Call> calls_;
  std::size_t idle_threads_ = 0;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace adhoc_communication
