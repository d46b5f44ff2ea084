// Local topics carried to other robots, whatever their type.
#pragma once

#include <ros/node_handle.h>
#include <ros/subscriber.h>

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "node/engine_host.hpp"
#include "node/service_pool.hpp"
#include "relay/relay_table.hpp"

namespace topic_tools {
class ShapeShifter;
}

namespace adhoc_communication {

/// Subscribes to the topics of a RelayTable and hands its messages to the radio, one thread for all of them. What this
/// node publishes itself, because it came from another robot, is never carried on: so nothing goes in circles.
class TopicRelay {
 public:
  using Send = std::function<void(SendRequest, std::function<void(const Outcome&)>)>;

  /// `prefix` is put before every local topic: /<self>/ in simulation mode, else empty.
  TopicRelay(ros::NodeHandle node, std::string prefix, const std::string& own_name, std::size_t max_packet_size);
  ~TopicRelay() { stop(); }

  /// From now on messages go out by `send`, which may not wait.
  void start(Send send);
  /// `send` is not called any more.
  void stop();

  /// A relay whose topics have been checked. Throws std::invalid_argument with one sentence.
  void add(RelayEntry entry);
  void remove(const std::string& topic, const std::string& destination, const std::string& remote_topic);
  std::vector<RelayReport> reports() const;

  // From the thread of the engine: these return at once.
  void robot_appeared(const std::string& robot);
  void robot_lost(const std::string& robot);
  void group_members(const std::vector<std::string>& members);
  void group_packet(const PacketReceived& packet);
  /// Asks a robot for the definition of a message it has sent. Callable from any thread, without waiting.
  void ask(const std::string& robot, const TypeName& type);
  /// Another robot asks for a definition.
  void answer(const PacketReceived& request);
  /// The root of a group names a new member.
  void new_member(const PacketReceived& word);

 private:
  void run();
  void work();
  void take(RelayTable::Id id, const ros::MessageEvent<topic_tools::ShapeShifter const>& event);
  void send(RelayTable::Transfer transfer);

  ros::NodeHandle node_;
  const std::string prefix_;
  Send send_;  ///< of the thread

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  RelayTable table_;
  ServicePool arrivals_{1};  ///< a thread of its own, so that no other callback of the node makes messages wait
  std::map<RelayTable::Id, ros::Subscriber> subscribers_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace adhoc_communication
