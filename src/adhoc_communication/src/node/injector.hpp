// Received packets become messages on local topics.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "adhoc_communication/types.hpp"
#include "node/payload.hpp"
#include "node/topic_filter.hpp"

namespace adhoc_communication {

/// Publishes in a thread of its own, because advertising asks the ROS master and must not hold up the engine.
/// Topics are latched. What cannot be published is counted and reported once per topic.
class Injector {
 public:
  /// `prefix` is put before every topic: /<self>/ in simulation mode, else empty.
  Injector(ros::NodeHandle node, std::string prefix, TopicFilter filter);
  ~Injector();

  /// Takes over a packet without waiting. When the queue is full the packet is dropped, counted and reported.
  void inject(PacketReceived packet);

  std::uint64_t dropped() const;

 private:
  struct Topic {
    std::string type;
    std::string md5sum;
    ros::Publisher publisher;
  };

  void run();
  void publish(const PacketReceived& packet);
  Topic& topic_for(const std::string& name, const SerializedMessage& message);
  void drop(const PacketReceived& packet, const std::string& reason);

  ros::NodeHandle node_;
  const std::string prefix_;
  const TopicFilter filter_;
  std::map<std::string, Topic> topics_;
  std::set<std::string> reported_topics_;

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<PacketReceived> queue_;
  std::size_t queued_octets_ = 0;
  std::uint64_t dropped_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

/// The local name of a topic from the air. Throws PayloadError when it is no valid ROS name.
std::string local_topic(const std::string& prefix, const std::string& topic);

}  // namespace adhoc_communication
