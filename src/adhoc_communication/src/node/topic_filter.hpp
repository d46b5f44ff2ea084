// Which local topics other robots may publish.
#pragma once

#include <string>
#include <vector>

namespace adhoc_communication {

/// Patterns as in a shell (* and ?), on full topic names. What matches `denied` is refused, then what does not match
/// `allowed`.
class TopicFilter {
 public:
  /// Patterns separated by blanks or commas; those without a leading '/' get one.
  TopicFilter(const std::string& allowed, const std::string& denied);

  void deny(const std::string& pattern);
  bool admits(const std::string& topic) const;

 private:
  std::vector<std::string> allowed_;
  std::vector<std::string> denied_;
};

}  // namespace adhoc_communication
