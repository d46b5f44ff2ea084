#include "relay/relay_queue.hpp"

#include <algorithm>
#include <utility>

namespace adhoc_communication {
namespace {

Time seconds(double count) { return std::chrono::duration_cast<Time>(std::chrono::duration<double>(count)); }

}  // namespace

RelayQueue::~RelayQueue() {
  for (const RelayTransfer& waiting : waiting_) budget_.give_back(waiting.message->bytes.size());
  if (last_) budget_.give_back(last_->bytes.size());
}

RelayReport RelayQueue::report() const {
  RelayReport report;
  report.entry = entry_;
  if (last_) report.type = last_->type;
  report.waiting = waiting_.size();
  for (const RelayTransfer& waiting : waiting_) report.octets += waiting.message->bytes.size();
  report.delivered = delivered_;
  report.dropped = dropped_;
  report.failed = failed_;
  report.last_failure = last_failure_;
  return report;
}

void RelayQueue::offer(RelayedMessage message, bool present, Time now) {
  remember_last(message);
  last_expires_ = entry_.lifetime > 0.0 ? now + seconds(entry_.lifetime) : Time::max();
  owed_.clear();  // they belong to the destination by now
  had_.clear();
  if (!present) {
    if (!entry_.latched) ++dropped_;
    return;
  }
  // A relay with a rate carries the newest message when its time has come; those in between are meant to be left out.
  const bool replaces = (entry_.rate > 0.0 || entry_.newest_only) && !waiting_.empty();
  if (replaces) {
    budget_.give_back(waiting_.back().message->bytes.size());
    waiting_.pop_back();
  }
  enqueue({std::move(message), entry_.destination, last_expires_});
}

/// Only a latched message keeps its octets; of the others the type is kept, to answer who lacks the definition.
void RelayQueue::remember_last(RelayedMessage message) {
  if (last_) budget_.give_back(last_->bytes.size());
  const bool was_whole = std::exchange(last_is_whole_, entry_.latched && budget_.fits(message->bytes.size()));
  if (last_is_whole_) {
    last_ = std::move(message);
  } else if (!last_ || was_whole || last_->definition.empty() || !(type_of(*last_) == type_of(*message))) {
    last_ =
        std::make_shared<SerializedMessage>(SerializedMessage{message->type, message->md5sum, message->definition, {}});
  }
  budget_.take(last_->bytes.size());
}

void RelayQueue::drop_oldest() {
  budget_.give_back(waiting_.front().message->bytes.size());
  waiting_.pop_front();
  ++dropped_;
}

bool RelayQueue::make_room(std::size_t octets) {
  while (!waiting_.empty() && (waiting_.size() >= kMostWaiting || !budget_.fits(octets))) drop_oldest();
  return budget_.fits(octets);
}

void RelayQueue::enqueue(RelayTransfer message) {
  const std::size_t octets = message.message->bytes.size();
  if (!make_room(octets)) {
    ++dropped_;
    return;
  }
  budget_.take(octets);
  waiting_.push_back(std::move(message));
}

void RelayQueue::owe_last(const std::string& destination, Time now) {
  if (!last_is_whole_ || last_expires_ <= now) return;
  due_ = std::min(due_, now);
  if (destination == entry_.destination) {
    enqueue({last_, destination, last_expires_});
  } else if (owed_.size() < kMostOwed && had_.count(destination) == 0) {
    owed_.insert(destination);
  }
}

void RelayQueue::destination_lost() {
  owed_.clear();
  had_.clear();
  while (!waiting_.empty()) drop_oldest();
}

void RelayQueue::drop_expired(Time now) {
  while (!waiting_.empty() && waiting_.front().expires <= now) drop_oldest();
  if (last_expires_ <= now) owed_.clear();
}

bool RelayQueue::ready(const MaySend& may_send) const {
  if (in_flight_ >= kMostInFlight) return false;
  if (!waiting_.empty()) return may_send(waiting_.front().destination, type_of(*waiting_.front().message));
  return next_owed(may_send) != owed_.end();
}

std::set<std::string>::const_iterator RelayQueue::next_owed(const MaySend& may_send) const {
  return std::find_if(owed_.begin(), owed_.end(),
                      [&](const std::string& destination) { return may_send(destination, type_of(*last_)); });
}

RelayTransfer RelayQueue::take(const MaySend& may_send, Time now) {
  ++in_flight_;
  if (waiting_.empty()) {
    const auto owed = next_owed(may_send);
    RelayTransfer first{last_, *owed, last_expires_};
    if (had_.size() < kMostOwed) had_.insert(*owed);
    owed_.erase(owed);
    return first;
  }
  if (entry_.rate > 0.0) due_ = now + seconds(1.0 / entry_.rate);
  RelayTransfer first = std::move(waiting_.front());
  waiting_.pop_front();
  budget_.give_back(first.message->bytes.size());
  return first;
}

void RelayQueue::finished(const MessageUnderWay& sent, bool delivered, const std::string& reason, bool present,
                          Time now, const std::vector<std::string>& missed) {
  ++(delivered ? delivered_ : failed_);
  if (delivered) return;
  last_failure_ = reason;
  if (sent.is_too_large) return;
  const bool by_itself = sent.destination != entry_.destination;  // also after it was away
  if (last_ != sent.message.lock() || (!by_itself && !present)) return;
  had_.erase(sent.destination);
  const Time due = std::max(due_, now + kRetry);
  // Those who have it are not to get it again because others have not.
  if (missed.empty()) owe_last(sent.destination, now);
  for (const std::string& member : missed) owe_last(member, now);
  due_ = due;
}

}  // namespace adhoc_communication
