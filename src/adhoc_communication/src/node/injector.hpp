// The thread in which received packets become messages on local topics.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>

#include "adhoc_communication/types.hpp"
#include "relay/inbox.hpp"

namespace adhoc_communication {

/// Large packets and the ROS master, which is asked when a topic is advertised, must not hold up the engine.
class Injector {
 public:
  Injector(std::unique_ptr<LocalTopics> topics, TopicFilter filter, InboxCalls calls);
  ~Injector();

  /// Takes over a packet without waiting. When the queue is full the packet is dropped, counted and reported.
  void inject(PacketReceived packet);

  struct Report {
    std::size_t waiting = 0;    ///< packets
    std::size_t octets = 0;     ///< of these
    std::uint64_t dropped = 0;  ///< so far
  };
  Report report() const;

 private:
  void run();
  void work();
  bool wait_for_packet(std::unique_lock<std::mutex>& lock);

  const std::unique_ptr<LocalTopics> topics_;
  Inbox inbox_;  ///< of the thread

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<PacketReceived> queue_;
  std::size_t queued_octets_ = 0;
  std::uint64_t dropped_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace adhoc_communication
