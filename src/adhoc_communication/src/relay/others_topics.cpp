#include "relay/others_topics.hpp"

#include "relay/message.hpp"

namespace adhoc_communication {

namespace {

PayloadError published_by_others(const std::string& topic) {
  return PayloadError("nodes of this robot publish '" + topic + "', so others may not, unless inject_allow names it");
}

}  // namespace

void OthersTopics::check_carried(const std::string& topic, Time now) {
  look(now);
  if (now >= ask_again_) ask(now);
  if (in_use_.of_others.count(topic) != 0) throw published_by_others(topic);
}

bool OthersTopics::check_new(const std::string& topic, Time now) {
  look(now);
  const bool refused = in_use_.of_others.count(topic) != 0;
  if (refused && now >= ask_again_) ask(now);
  if (in_use_.of_others.count(topic) != 0) throw published_by_others(topic);
  if (!learned(now)) return false;
  if (in_use_.of_others.count(topic) != 0) throw published_by_others(topic);
  if (!answered_) {
    throw PayloadError("the ROS master does not answer whether nodes of this robot publish '" + topic +
                       "'; look whether it runs");
  }
  return true;
}

bool OthersTopics::knows_subscribers(Time now) {
  look(now);
  return learned(now);
}

std::size_t OthersTopics::subscribers(const std::string& topic) const {
  const auto found = in_use_.subscribers.find(topic);
  return found == in_use_.subscribers.end() ? 0 : found->second;
}

bool OthersTopics::settle(Time now) {
  look(now);
  return std::exchange(news_, false);
}

/// What is known is as new as it can be: learned at this moment, or not to be learned soon. If not, it is asked.
bool OthersTopics::learned(Time now) {
  if (learned_ == now) return true;
  if (!asked_ && !answered_ && now < ask_again_) return true;
  ask(now);
  return learned_ == now;
}

void OthersTopics::ask(Time now) {
  if (asked_) return;
  asked_ = now;
  if (!std::exchange(open_, true)) local_.ask();
  look(now);
}

/// An answer that nobody has waited for any more may be old: the next new topic is asked for once more.
void OthersTopics::look(Time now) {
  std::optional<LocalTopics::Answer> answer;
  if (open_) answer = local_.take_answer();
  if (!answer && (!asked_ || now - *asked_ < kPatience)) return;
  answered_ = answer && answer->in_use;
  if (answer) open_ = false;
  if (answered_) in_use_ = std::move(*answer->in_use);
  if (asked_) {
    learned_ = now;
    news_ = true;
  }
  asked_.reset();
  ask_again_ = now + (answered_ ? kAskAgain : kAskAgainAfterSilence);
}

}  // namespace adhoc_communication
