// What one subscriber of a topic has not taken yet.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <utility>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// Messages are shared with the queues of other subscribers. When it is full the oldest are dropped; a single message
/// may be larger than the bound.
class SubscriberQueue {
 public:
  using Message = std::shared_ptr<const Bytes>;
  static constexpr std::size_t kMostMessages = 100;
  static constexpr std::size_t kMostOctets = 8'000'000;
  static constexpr std::size_t kMostMessagesInHand = 50;       ///< handed over and not taken
  static constexpr std::size_t kMostOctetsInHand = 1'000'000;  ///< of these, or one message

  struct InHand {
    std::size_t messages = 0;
    std::size_t octets = 0;
  };

  /// Returns how many messages had to be dropped.
  std::size_t add(Message message) {
    octets_ += message->size();
    waiting_.push_back(std::move(message));
    std::size_t dropped = 0;
    while (waiting_.size() > kMostMessages || (octets_ > kMostOctets && waiting_.size() > 1)) {
      pop();
      ++dropped;
    }
    return dropped;
  }
  /// The next message, if the subscriber can be handed one more than it has not taken.
  Message next(const InHand& in_hand) {
    if (waiting_.empty() || in_hand.messages >= kMostMessagesInHand) return nullptr;
    if (in_hand.messages > 0 && in_hand.octets + waiting_.front()->size() > kMostOctetsInHand) return nullptr;
    return pop();
  }
  bool empty() const { return waiting_.empty(); }
  std::size_t octets() const { return octets_; }

 private:
  Message pop() {
    Message message = std::move(waiting_.front());
    waiting_.pop_front();
    octets_ -= message->size();
    return message;
  }

  std::deque<Message> waiting_;
  std::size_t octets_ = 0;
};

}  // namespace adhoc_communication
