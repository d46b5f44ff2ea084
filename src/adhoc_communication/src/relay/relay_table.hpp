// Which local topics are carried to which robots: what waits, what is sent next, who knows which definition. No ROS, no
// thread, no clock.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "relay/group_news.hpp"
#include "relay/letters.hpp"
#include "relay/message.hpp"
#include "relay/relay_entry.hpp"

namespace adhoc_communication {

/// A relay and what it has done.
struct RelayReport {
  RelayEntry entry;
  std::string type;  ///< of the last message; empty before the first one
  std::size_t waiting = 0;
  std::size_t octets = 0;       ///< of the waiting messages
  std::uint64_t delivered = 0;  ///< for a broadcast: sent
  std::uint64_t dropped = 0;    ///< never sent: newer ones pushed them out, or the destination was not there
  std::uint64_t failed = 0;     ///< sent without success
  std::string last_failure;
};

/// A message's definition goes to each destination once; messages behind it name their type only. Who lacks the
/// definition asks for it (answer()). Each relay keeps its own order and drops its oldest message when it is slower
/// than its topic. A message whose lifetime is over is dropped, and given to nobody who comes late.
class RelayTable {
 public:
  using Id = std::uint64_t;
  using Message = std::shared_ptr<const SerializedMessage>;

  static constexpr std::size_t kMostRelays = 64;
  static constexpr std::size_t kMostWaiting = 16;         ///< messages of one relay
  static constexpr std::size_t kMostOctets = 64'000'000;  ///< of all waiting and latched messages
  static constexpr std::size_t kMostInFlight = 4;         ///< messages of one relay
  static constexpr std::size_t kMostKnown = 4096;         ///< pairs of destination and type
  static constexpr std::size_t kMostOwed = 256;           ///< late members of a group, for one relay
  static constexpr Time kRetry = std::chrono::seconds(1);

  explicit RelayTable(std::string own_name) : own_name_(std::move(own_name)), own_group_("mc_" + own_name_) {}

  /// Throws std::invalid_argument with one sentence for an entry that cannot work, is there already, or is too many.
  Id add(RelayEntry entry);
  /// Every relay of that topic and destination; an empty remote topic stands for any. Returns those removed.
  std::vector<Id> remove(const std::string& topic, const std::string& destination, const std::string& remote_topic);
  std::vector<RelayReport> reports() const;

  void offer(Id id, Message message, Time now);
  void robot_appeared(const std::string& robot, Time now);
  void robot_lost(const std::string& robot);

  // Groups: a robot that joins late is sent by itself what is latched, the newest of each relay.
  /// Who belongs to the own group now. Others who have sent it latched messages are told of newcomers.
  void group_members(const std::vector<std::string>& members, Time now);
  /// A packet has come for a group.
  void group_packet(const PacketReceived& packet);
  /// The root of another group names a new member. Throws PayloadError.
  void new_member(const PacketReceived& word, Time now);

  // Definitions.
  /// A robot is to be asked for one.
  void ask(const std::string& robot, const TypeName& type) { letters_.ask(robot, type); }
  /// Another robot asks for one, which it gets if a relay carries that type. Throws PayloadError.
  void answer(const PacketReceived& request);

  struct Transfer {
    std::uint64_t number = 0;
    SendRequest request;
  };
  /// The next message or letter to send; each has to be reported with finished().
  std::optional<Transfer> next(Time now);
  void finished(std::uint64_t number, bool delivered, const std::string& reason, Time now);
  /// Instead of finished(): a newer message has taken its place.
  void superseded(std::uint64_t number);
  /// When next() may have something by the passing of time alone; Time::max() if never.
  Time next_deadline() const;

 private:
  struct Waiting {
    Message message;
    std::string destination;
    Time expires = Time::max();
  };
  struct Relay {
    RelayEntry entry;
    std::deque<Waiting> waiting;
    Message last;
    Time last_expires = Time::max();
    std::set<std::string> owed;  ///< late members of the group, which are sent the last message by themselves
    std::size_t in_flight = 0;
    Time due{0};
    std::uint64_t delivered = 0;
    std::uint64_t dropped = 0;
    std::uint64_t failed = 0;
    std::string last_failure;
  };
  using Lesson = std::pair<std::string, TypeName>;  ///< a destination and a type
  struct InFlight {
    Id relay = 0;
    Waiting message;
    bool teaches = false;
  };

  void check(const RelayEntry& entry) const;
  bool present(const std::string& destination) const;
  bool ready(const Relay& relay) const;
  std::set<std::string>::iterator next_owed(const Relay& relay) const;
  bool teaches(const std::string& destination, const Message& message) const;
  void drop_expired(Relay& relay, Time now);
  Waiting take_first(Relay& relay);
  std::optional<InFlight> end_transfer(std::uint64_t number, bool delivered);
  bool make_room(Relay& relay, std::size_t octets);
  void drop_oldest(Relay& relay);
  void enqueue(Relay& relay, Waiting message);
  void enqueue_last(Relay& relay, const std::string& destination, Time now);
  void owe(const std::string& group, const std::string& member, Time now);
  void remember_last(Relay& relay, Message message);
  Transfer start(Id id, Relay& relay, Time now);
  void forget(const std::string& destination);

  const std::string own_name_;
  const std::string own_group_;
  std::map<Id, Relay> relays_;
  Letters letters_;
  GroupNews news_;
  std::set<std::string> robots_;
  std::set<std::string> members_;
  std::set<Lesson> known_;
  std::map<Lesson, std::uint64_t> teaching_;  ///< the transfer that carries the definition
  std::map<std::uint64_t, InFlight> in_flight_;
  std::size_t octets_ = 0;
  Id next_id_ = 1;
  Id last_served_ = 0;
  std::uint64_t next_number_ = 1;
};

}  // namespace adhoc_communication
