#include "node/injector.hpp"

#include <ros/console.h>

#include <chrono>
#include <utility>
#include <vector>

#include "link/steady_now.hpp"
#include "node/end_node.hpp"
#include "run_guarded.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

constexpr std::size_t kMostTold = 256;
constexpr std::chrono::milliseconds kConnectionPeriod{5};  ///< in which it is looked whether subscribers have connected

}  // namespace

Injector::Injector(std::unique_ptr<LocalTopics> topics, TopicFilter filter, InboxCalls calls)
    : topics_(std::move(topics)), inbox_(*topics_, std::move(filter), std::move(calls)) {
  thread_ = std::thread([this] { run(); });
}

Injector::~Injector() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  arrived_.notify_all();
  thread_.join();
}

void Injector::inject(PacketReceived packet) {
  std::vector<PacketReceived> told;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (PacketReceived& dropped : queue_.add(std::move(packet))) {
      ++dropped_;
      if (is_to_be_told(dropped.source)) told.push_back(std::move(dropped));
    }
  }
  arrived_.notify_one();
  for (const PacketReceived& dropped : told) {
    ROS_ERROR(
        "Packets of %s arrive faster than they can be published; one for topic '%s' was dropped (reported once per "
        "robot)",
        dropped.source.c_str(), escaped(dropped.topic).c_str());
  }
}

bool Injector::is_to_be_told(const std::string& robot) {
  return robots_told_.size() < kMostTold && robots_told_.insert(robot).second;
}

Injector::Report Injector::report() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return {queue_.size(), queue_.octets(), dropped_};
}

void Injector::run() {
  run_guarded(
      "publishing", [this] { work(); }, end_node);
}

void Injector::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (wait_for_packet(lock)) {
    PacketReceived packet = queue_.take();
    lock.unlock();
    inbox_.take(std::move(packet), steady_now());
    lock.lock();
    dropped_ += inbox_.take_dropped();
  }
}

/// False when there will be none any more.
bool Injector::wait_for_packet(std::unique_lock<std::mutex>& lock) {
  const auto due = [this] { return stopping_ || !queue_.empty(); };
  while (inbox_.anything_waits()) {
    const bool arrived = arrived_.wait_for(lock, kConnectionPeriod, due);
    lock.unlock();
    inbox_.release(steady_now());
    lock.lock();
    if (arrived) return !stopping_;
  }
  arrived_.wait(lock, due);
  return !stopping_;
}

}  // namespace adhoc_communication
