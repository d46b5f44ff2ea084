#include "node/service_pool.hpp"

#include <ros/console.h>

#include <algorithm>

#include "run_guarded.hpp"

namespace adhoc_communication {

void ServicePool::addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t owner_id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (stopping_) return;
  calls_.push_back({callback, owner_id});
  if (calls_.size() > idle_threads_ && threads_.size() < max_threads_) {
    threads_.emplace_back([this] { work(); });
  }
  arrived_.notify_one();
}

void ServicePool::removeByID(std::uint64_t owner_id) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto is_owned = [owner_id](const Call& call) { return call.owner_id == owner_id; };
  calls_.erase(std::remove_if(calls_.begin(), calls_.end(), is_owned), calls_.end());
}

void ServicePool::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
    calls_.clear();
  }
  arrived_.notify_all();
  for (auto& thread : threads_) {
    if (thread.joinable()) thread.join();
  }
}

void ServicePool::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    ++idle_threads_;
    arrived_.wait(lock, [this] { return stopping_ || !calls_.empty(); });
    --idle_threads_;
    if (stopping_) return;
    const auto callback = std::move(calls_.front().callback);
    calls_.pop_front();
    lock.unlock();
    run_guarded(
        "a call", [&] { callback->call(); }, [](const std::string& text) { ROS_ERROR("%s", text.c_str()); });
    lock.lock();
  }
}

}  // namespace adhoc_communication
