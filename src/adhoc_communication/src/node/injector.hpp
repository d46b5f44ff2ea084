// The thread in which received packets become messages on local topics.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "adhoc_communication/types.hpp"
#include "relay/inbox.hpp"
#include "relay/packet_queue.hpp"

namespace adhoc_communication {

/// Unpacking large packets must not hold up the engine.
class Injector {
 public:
  Injector(std::unique_ptr<LocalTopics> topics, TopicFilter filter, InboxCalls calls);
  ~Injector();

  /// Takes over a packet without waiting. What the queue has no room for is dropped, counted, and reported once per
  /// robot.
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
  bool is_to_be_told(const std::string& robot);
  bool wait_for_packet(std::unique_lock<std::mutex>& lock);

  const std::unique_ptr<LocalTopics> topics_;
  Inbox inbox_;  ///< of the thread

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  PacketQueue queue_;
  std::set<std::string> robots_told_;
  std::uint64_t dropped_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace adhoc_communication
