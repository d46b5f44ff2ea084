// Received packets become messages on local topics.
#pragma once

#include <ros/node_handle.h>
#include <ros/publisher.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "adhoc_communication/types.hpp"
#include "node/definitions.hpp"
#include "node/payload.hpp"
#include "node/topic_filter.hpp"
#include "node/topic_table.hpp"

namespace adhoc_communication {

/// Unpacks and publishes in a thread of its own: large packets and the ROS master, which is asked when a topic is
/// advertised, must not hold up the engine.
/// A topic is latched where its first message says so. A message whose definition is not known yet waits for it, and
/// one whose topic is new for subscribers to connect; others go on. What cannot be published is counted and reported
/// once per topic.
class Injector {
 public:
  /// Asks a robot for the definition of a type, without waiting.
  using AskForDefinition = std::function<void(const std::string& robot, const TypeName& type)>;
  /// Another robot asks for one.
  using AnswerRequest = std::function<void(const PacketReceived& request)>;

  /// `prefix` is put before every topic: /<self>/ in simulation mode, else empty.
  Injector(ros::NodeHandle node, std::string prefix, TopicFilter filter, AskForDefinition ask_for_definition,
           AnswerRequest answer_request);
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
  using Topics = TopicTable<ros::Publisher>;

  void run();
  void work();
  bool wait_for_packet(std::unique_lock<std::mutex>& lock);
  void take(PacketReceived& packet);
  std::string full_name(const std::string& topic) const;
  void check_topic(const std::string& full_name) const;
  void learn_definition(const SerializedMessage& message);
  /// False when the message has to wait for its definition.
  bool complete(SerializedMessage& message, const PacketReceived& packet);
  void publish(const PacketReceived& packet, SerializedMessage message);
  Topics::Topic& topic_for(const std::string& name, const SerializedMessage& message, const PacketReceived& packet);
  void drop(const PacketReceived& packet, const std::string& reason);
  void count_dropped(std::uint64_t packets);

  ros::NodeHandle node_;
  const std::string prefix_;
  const TopicFilter filter_;
  const AskForDefinition ask_for_definition_;
  const AnswerRequest answer_request_;
  Definitions definitions_;
  Topics topics_;
  std::set<std::string> reported_topics_;

  mutable std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<PacketReceived> queue_;
  std::size_t queued_octets_ = 0;
  std::uint64_t dropped_ = 0;
  bool stopping_ = false;
  std::thread thread_;
};

/// The local name of a topic from the air, without needless slashes. Throws PayloadError when it is no valid ROS name.
std::string local_topic(const std::string& prefix, const std::string& topic);

}  // namespace adhoc_communication
