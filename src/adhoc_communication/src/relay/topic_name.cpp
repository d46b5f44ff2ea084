#include "relay/topic_name.hpp"

#include <algorithm>
#include <cctype>

#include "relay/message.hpp"
#include "texts.hpp"

namespace adhoc_communication {
namespace {

bool belongs_to_names(char character) {
  return std::isalnum(static_cast<unsigned char>(character)) != 0 || character == '_' || character == '/';
}

/// As ROS has it, without private names: these belong to one node.
bool valid(const std::string& topic) {
  if (topic.empty() || (topic[0] != '/' && std::isalpha(static_cast<unsigned char>(topic[0])) == 0)) return false;
  return std::all_of(topic.begin(), topic.end(), belongs_to_names);
}

std::string without_needless_slashes(const std::string& topic) {
  std::string name;
  for (const char character : topic) {
    if (character != '/' || name.empty() || name.back() != '/') name += character;
  }
  if (name.size() > 1 && name.back() == '/') name.pop_back();
  return name;
}

}  // namespace

std::string local_topic(const std::string& prefix, const std::string& topic) {
  if (!valid(topic)) throw PayloadError("topic '" + escaped(topic) + "' is not a valid topic name");
  const auto first = topic.find_first_not_of('/');
  if (first == std::string::npos) throw PayloadError("topic '" + topic + "' has no name");
  return without_needless_slashes(prefix.empty() ? topic : prefix + topic.substr(first));
}

}  // namespace adhoc_communication
