// Which local topics are carried to which robots, and what is sent next. No ROS, no thread, no clock.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "adhoc_communication/types.hpp"
#include "relay/group_news.hpp"
#include "relay/lessons.hpp"
#include "relay/letters.hpp"
#include "relay/message.hpp"
#include "relay/octet_budget.hpp"
#include "relay/relay_entry.hpp"
#include "relay/relay_queue.hpp"

namespace adhoc_communication {

/// A message's definition goes to each destination once; messages behind it name their type only. Who lacks the
/// definition asks for it (answer()). Each relay keeps its own order.
class RelayTable {
 public:
  using Id = std::uint64_t;
  using Message = RelayedMessage;

  static constexpr std::size_t kMostRelays = 64;
  static constexpr std::size_t kMostOctets = 64'000'000;  ///< of all waiting and latched messages

  /// `max_packet_size`: of the engine, which refuses what is larger.
  explicit RelayTable(std::string own_name, std::size_t max_packet_size = EngineOptions().max_packet_size)
      : own_name_(std::move(own_name)), own_group_("mc_" + own_name_), max_packet_size_(max_packet_size) {}

  /// Throws std::invalid_argument with one sentence for an entry that cannot work, is there already, or is too many.
  Id add(RelayEntry entry);
  /// Every relay of that topic and destination; an empty remote topic stands for any. Returns those removed.
  std::vector<Id> remove(const std::string& topic, const std::string& destination, const std::string& remote_topic);
  void remove(Id id) { relays_.erase(id); }
  bool has(Id id) const { return relays_.count(id) != 0; }
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
  /// `missed`: of a group, the members that have not got it; nobody named means that nobody may have.
  void finished(std::uint64_t number, bool delivered, const std::string& reason, Time now,
                const std::vector<std::string>& missed = {});
  /// Instead of finished(): a newer message has taken its place.
  void superseded(std::uint64_t number);
  /// When next() may have something by the passing of time alone; Time::max() if never.
  Time next_deadline() const;

 private:
  struct InFlight {
    Id relay = 0;
    MessageUnderWay message;
  };

  void check(const RelayEntry& entry) const;
  bool present(const std::string& destination) const;
  RelayQueue::MaySend may_send() const;
  std::optional<InFlight> end_transfer(std::uint64_t number, bool delivered);
  void owe(const std::string& group, const std::string& member, Time now);
  Transfer start(Id id, RelayQueue& relay, Time now);

  const std::string own_name_;
  const std::string own_group_;
  const std::size_t max_packet_size_;
  OctetBudget budget_{kMostOctets};
  std::map<Id, RelayQueue> relays_;
  Letters letters_;
  GroupNews news_;
  std::set<std::string> robots_;
  std::set<std::string> members_;
  Lessons lessons_;
  std::map<std::uint64_t, InFlight> in_flight_;
  Id next_id_ = 1;
  Id last_served_ = 0;
  std::uint64_t next_number_ = 1;
};

}  // namespace adhoc_communication
