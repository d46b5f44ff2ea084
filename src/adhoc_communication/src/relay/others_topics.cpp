#include "relay/others_topics.hpp"

#include <optional>
#include <utility>

#include "relay/message.hpp"

namespace adhoc_communication {

void OthersTopics::check_free(const std::string& topic, bool carried, Time now) {
  const bool is_new = !carried && topics_.count(topic) == 0;
  if (now >= ask_again_ || (is_new && answered_)) ask(now);
  if (topics_.count(topic) != 0) {
    throw PayloadError("nodes of this robot publish '" + topic + "', so others may not, unless inject_allow names it");
  }
  if (is_new && !answered_) {
    throw PayloadError("the ROS master does not answer whether nodes of this robot publish '" + topic +
                       "'; look whether it runs");
  }
}

void OthersTopics::ask(Time now) {
  std::optional<std::set<std::string>> topics = local_.of_others();
  answered_ = topics.has_value();
  ask_again_ = now + (answered_ ? kAskAgain : kAskAgainAfterSilence);
  if (topics) topics_ = std::move(*topics);
}

}  // namespace adhoc_communication
