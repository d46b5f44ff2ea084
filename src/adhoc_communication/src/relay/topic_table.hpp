// The topics that packets of other robots are published on, and the messages that wait for subscribers to connect.
#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "relay/local_topics.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {

/// When the table is full, or a robot has brought more topics than its share, the one used longest ago makes room: of
/// all, or of that robot's. When latched topics keep too many octets, it is that of the robot who keeps most, or of the
/// one beyond its share; a single message may be larger than that.
class TopicTable {
 public:
  static constexpr std::size_t kMostTopics = 256;
  static constexpr std::size_t kMostOfASource = 64;
  static constexpr std::size_t kMostKeptOctets = 12'000'000;      ///< latched, if it is more than one message
  static constexpr std::size_t kMostKeptOfASource = 6'000'000;    ///< of these, likewise
  static constexpr std::size_t kMostWaiting = 100;                ///< messages of one topic
  static constexpr std::size_t kMostWaitingOctets = 8'000'000;    ///< of all
  static constexpr Time kLongestOffer = std::chrono::seconds(5);  ///< until nodes can find a topic
  static constexpr Time kLongestConnection = std::chrono::seconds(3);

  struct Topic {
    std::string type;
    std::string md5sum;
    std::string source;  ///< the robot that brought it
    std::unique_ptr<Publication> publication;
    std::size_t subscribers = 0;  ///< that are to connect
    bool latched = false;
    std::size_t kept = 0;  ///< octets of the message that late subscribers get
    bool offered = false;
    Time connects_until{0};                   ///< or is to be offered until then
    Time used{0};                             ///< when a message was published on it last
    std::deque<SerializedMessage> waiting{};  ///< until they have
    bool connecting = true;
  };

  Topic* find(const std::string& name);
  bool knows(const std::string& name) const { return topics_.count(name) != 0; }
  std::size_t size() const { return topics_.size(); }
  bool anything_waits() const { return waiting_octets_ > 0 || subscribers_wait_; }

  Topic& add(const std::string& name, Topic topic, Time now);
  /// With what waits for its subscribers.
  void forget(const std::string& name);
  /// What subscribers do not get because they cannot find the topic yet, or are still connecting, is lost to them:
  /// until they have, the messages of that topic wait, and no others.
  void publish(Topic& topic, SerializedMessage message, Time now);
  /// Publishes what has waited for subscribers that have connected, or long enough, and hands slow ones what they can
  /// take.
  void release_all(Time now);

  struct Dropped {
    std::string topic;
    std::uint64_t messages = 0;
  };
  /// What slow subscribers have not got, since the last call.
  std::vector<Dropped> take_dropped();

  struct GivenUp {
    std::string topic;
    std::string source;
  };
  struct Refused {
    std::string topic;
    std::string source;
    std::string reason;
    std::uint64_t messages = 0;  ///< that have waited
  };
  /// Topics that could not be offered, given up since the last call.
  std::vector<Refused> take_refused() { return std::exchange(refused_, {}); }

  /// Topics given up since the last call because of the octets that latched ones keep.
  std::vector<GivenUp> take_given_up() { return std::exchange(given_up_, {}); }

 private:
  using Predicate = std::function<bool(const Topic&)>;

  static bool connects(Topic& topic, Time now);
  void release(Topic& topic);
  void give_up_refused();
  void put_out(Topic& topic, const SerializedMessage& message);
  void make_room_beside(const Topic& topic);
  std::size_t kept_of(const std::string& source) const;
  std::size_t count(const Predicate& counts) const;
  void forget_least_used(const Predicate& candidate) { forget(least_used(candidate)); }
  std::map<std::string, Topic>::iterator least_used(const Predicate& candidate);
  void forget(std::map<std::string, Topic>::iterator topic);

  std::map<std::string, Topic> topics_;
  std::size_t waiting_octets_ = 0;
  std::size_t kept_octets_ = 0;
  bool subscribers_wait_ = false;
  std::vector<GivenUp> given_up_;
  std::vector<Refused> refused_;
};

}  // namespace adhoc_communication
