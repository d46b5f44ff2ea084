// One relayed topic: what waits, what is latched, to whom it is owed, when the next message is due.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "relay/message.hpp"
#include "relay/octet_budget.hpp"
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

using RelayedMessage = std::shared_ptr<const SerializedMessage>;

inline TypeName type_of(const SerializedMessage& message) { return {message.type, message.md5sum}; }

/// A message for one destination.
struct RelayTransfer {
  RelayedMessage message;
  std::string destination;
  Time expires = Time::max();
};

/// A message on its way to one destination. Its octets, which are in the request by now, are not kept.
struct MessageUnderWay {
  std::weak_ptr<const SerializedMessage> message;
  TypeName type;
  std::string destination;
  bool is_too_large = false;  ///< for any packet, so trying again is of no use
};

/// Drops its oldest message when it is slower than its topic. A message whose lifetime is over is dropped, and given to
/// nobody who comes late. The octets of all relays together are bounded by a budget.
class RelayQueue {
 public:
  static constexpr std::size_t kMostWaiting = 16;
  static constexpr std::size_t kMostInFlight = 4;
  static constexpr std::size_t kMostOwed = 256;  ///< late members of a group
  static constexpr Time kRetry = std::chrono::seconds(1);

  /// Whether a message of that type can go there now.
  using MaySend = std::function<bool(const std::string& destination, const TypeName& type)>;

  RelayQueue(RelayEntry entry, OctetBudget& budget) : entry_(std::move(entry)), budget_(budget) {}
  ~RelayQueue();
  RelayQueue(const RelayQueue&) = delete;
  RelayQueue& operator=(const RelayQueue&) = delete;

  const RelayEntry& entry() const { return entry_; }
  /// The last message, without its octets unless the relay is latched; null before the first one.
  const RelayedMessage& last() const { return last_; }
  RelayReport report() const;

  /// `present`: the destination is there.
  void offer(RelayedMessage message, bool present, Time now);
  /// What is latched is to go to the destination, or to a late member of it by itself.
  void owe_last(const std::string& destination, Time now);
  void destination_lost();
  void member_left(const std::string& member) {
    owed_.erase(member);
    had_.erase(member);
  }
  /// What it has got is gone with its run.
  void member_lost(const std::string& member) { had_.erase(member); }

  void drop_expired(Time now);
  /// Apart from its rate.
  bool ready(const MaySend& may_send) const;
  Time due() const { return due_; }
  /// ready() holds.
  RelayTransfer take(const MaySend& may_send, Time now);
  void ended() { --in_flight_; }
  /// How a transfer ended that ended(). `missed`: of a group, the members that have not got it; nobody named means that
  /// nobody may have.
  void finished(const MessageUnderWay& sent, bool delivered, const std::string& reason, bool present, Time now,
                const std::vector<std::string>& missed);

 private:
  std::set<std::string>::const_iterator next_owed(const MaySend& may_send) const;
  void remember_last(RelayedMessage message);
  void enqueue(RelayTransfer message);
  bool make_room(std::size_t octets);
  void drop_oldest();

  RelayEntry entry_;
  OctetBudget& budget_;
  std::deque<RelayTransfer> waiting_;
  RelayedMessage last_;
  bool last_is_whole_ = false;  ///< with its octets, of which a message may have none
  Time last_expires_ = Time::max();
  std::set<std::string> owed_;  ///< members of the group that are to be sent the last message by themselves
  std::set<std::string> had_;   ///< those to whom it has gone
  std::size_t in_flight_ = 0;
  Time due_{0};
  std::uint64_t delivered_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t failed_ = 0;
  std::string last_failure_;
};

}  // namespace adhoc_communication
