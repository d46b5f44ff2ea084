#include "relay/relay_entry.hpp"

#include <array>
#include <stdexcept>

#include "relay/message.hpp"
#include "relay/topic_name.hpp"

namespace adhoc_communication {
namespace {

const std::array<const char*, 4> kPriorities = {"control", "position", "normal", "bulk"};

}  // namespace

Priority parse_priority(const std::string& text) {
  if (text.empty()) return Priority::kNormal;
  for (std::size_t i = 0; i < kPriorities.size(); ++i) {
    if (text == kPriorities[i]) return static_cast<Priority>(i);
  }
  throw std::invalid_argument("has the priority '" + text + "', which is none of control, position, normal, bulk");
}

std::string to_text(Priority priority) { return kPriorities.at(static_cast<std::size_t>(priority)); }

void check_topics(const RelayEntry& entry) {
  try {
    local_topic("", entry.topic);
    if (!entry.remote_topic.empty()) local_topic("", entry.remote_topic);
  } catch (const PayloadError& error) {
    throw std::invalid_argument("has a wrong name: " + std::string(error.what()));
  }
}

}  // namespace adhoc_communication
