// Which local topics other robots may publish.
#pragma once

#include <string>
#include <vector>

namespace adhoc_communication {

/// Patterns as in a shell (* and ?), on full topic names. A topic that `allowed` names without a pattern is admitted.
/// Of all others what matches `denied` is refused, then what does not match `allowed`.
class TopicFilter {
 public:
  /// Patterns separated by blanks or commas; those without a leading '/' get one.
  TopicFilter(const std::string& allowed, const std::string& denied);

  /// Whatever is allowed.
  void never(const std::string& pattern);
  bool admits(const std::string& topic) const;
  /// The topic is allowed by its name.
  bool names(const std::string& topic) const;

 private:
  std::vector<std::string> allowed_;
  std::vector<std::string> denied_;
  std::vector<std::string> never_;
};

}  // namespace adhoc_communication
