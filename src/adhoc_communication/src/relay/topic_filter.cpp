#include "relay/topic_filter.hpp"

#include <fnmatch.h>

#include <algorithm>

namespace adhoc_communication {
namespace {

std::string absolute(const std::string& pattern) {
  return pattern[0] == '/' || pattern[0] == '*' ? pattern : "/" + pattern;
}

std::vector<std::string> patterns_of(const std::string& text) {
  constexpr char kSeparators[] = " ,\t\n";
  std::vector<std::string> patterns;
  for (auto begin = text.find_first_not_of(kSeparators); begin != std::string::npos;) {
    const auto end = std::min(text.find_first_of(kSeparators, begin), text.size());
    patterns.push_back(absolute(text.substr(begin, end - begin)));
    begin = text.find_first_not_of(kSeparators, end);
  }
  return patterns;
}

bool matches_any(const std::vector<std::string>& patterns, const std::string& topic) {
  return std::any_of(patterns.begin(), patterns.end(),
                     [&](const std::string& pattern) { return fnmatch(pattern.c_str(), topic.c_str(), 0) == 0; });
}

}  // namespace

TopicFilter::TopicFilter(const std::string& allowed, const std::string& denied)
    : allowed_(patterns_of(allowed)), denied_(patterns_of(denied)) {}

void TopicFilter::never(const std::string& pattern) { never_.push_back(absolute(pattern)); }

bool TopicFilter::names(const std::string& topic) const {
  return std::find(allowed_.begin(), allowed_.end(), topic) != allowed_.end();
}

bool TopicFilter::admits(const std::string& topic) const {
  if (matches_any(never_, topic)) return false;
  return names(topic) || (!matches_any(denied_, topic) && matches_any(allowed_, topic));
}

}  // namespace adhoc_communication
