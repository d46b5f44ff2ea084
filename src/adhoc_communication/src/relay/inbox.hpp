// What becomes of packets of other robots: published here, held until their definition is known, or refused. No ROS, no
// thread, no clock.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>

#include "adhoc_communication/types.hpp"
#include "relay/definitions.hpp"
#include "relay/local_topics.hpp"
#include "relay/message.hpp"
#include "relay/others_topics.hpp"
#include "relay/packet_queue.hpp"
#include "relay/subscriber_queue.hpp"
#include "relay/topic_filter.hpp"
#include "relay/topic_table.hpp"

namespace adhoc_communication {

/// What an Inbox cannot do by itself.
struct InboxCalls {
  /// The message in a packet. Throws PayloadError.
  std::function<SerializedMessage(const PacketReceived& packet)> decode;
  /// A robot is to be asked for the definition of a type.
  std::function<void(const std::string& robot, const TypeName& type)> ask;
  /// Another robot asks for one.
  std::function<void(const PacketReceived& request)> answer;
  /// The root of a group names a new member.
  std::function<void(const PacketReceived& word)> new_member;
  /// One sentence for people.
  std::function<void(const std::string& text)> tell;
};

/// A topic is latched where its first message says so. A message whose definition is not known yet waits for it, and
/// one whose topic is new until it is known who uses that here, and for subscribers to connect; others go on. What
/// cannot be published is counted and told once per topic, topics given up once per robot.
class Inbox {
 public:
  Inbox(LocalTopics& local, TopicFilter filter, InboxCalls calls);

  void take(PacketReceived packet, Time now);
  /// For an answer on topics, a definition, for subscribers to connect, or for them to take it.
  bool anything_waits() const { return others_.waits() || topics_.anything_waits() || definitions_.awaits_any(); }
  /// Publishes what has waited for an answer, for subscribers that have connected, or long enough, or that take more
  /// now. Asks again for definitions that have not come.
  void release(Time now);
  /// Packets dropped since the last call.
  std::uint64_t take_dropped();

 private:
  static constexpr std::size_t kMostTold = 256;  ///< topics, and robots
  /// A topic of that silence may get another type from any robot; from the one that brought it, at any time.
  static constexpr Time kTypeStands = std::chrono::seconds(10);

  void process(PacketReceived packet, Time now);
  void carry_out(PacketReceived& packet, Time now);
  bool may_be_unpacked(const PacketReceived& packet, Time now);
  bool check_topic(const std::string& full_name, Time now);
  void hold(PacketReceived& packet);
  void settle(Time now);
  void learn_definition(const SerializedMessage& message, const std::string& source, Time now);
  bool complete(SerializedMessage& message, PacketReceived& packet, Time now);
  void publish(const PacketReceived& packet, SerializedMessage message, Time now);
  TopicTable::Topic& topic_for(const std::string& name, const SerializedMessage& message, const PacketReceived& packet,
                               Time now);
  void drop(const PacketReceived& packet, const std::string& reason);
  void tell_of_slow_subscribers();
  void tell_of_topics_given_up();
  void tell_of_topics_refused();
  void tell_of(const PacketReceived& packet, const std::string& reason);

  LocalTopics& local_;
  OthersTopics others_;
  const TopicFilter filter_;
  const InboxCalls calls_;
  Definitions definitions_;
  PacketQueue held_;  ///< for topics of which it is asked who uses them
  TopicTable topics_;
  std::set<std::string> topics_told_;
  std::set<std::string> robots_told_;
  std::set<std::string> slow_topics_told_;
  std::uint64_t dropped_ = 0;
};

}  // namespace adhoc_communication
