// When sends end at the latest, and which of them a newer one may take the place of.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "deadlines.hpp"

namespace adhoc_communication::transport {

/// Knows only sends that have a deadline or that newer ones may replace; each until end().
class SendTerms {
 public:
  /// Destination and topic.
  using Subject = std::pair<std::string, std::string>;

  void expire_at(SendId id, Time deadline);
  /// From now on this is the newest send of its subject.
  void make_newest(SendId id, const Subject& subject);
  void end(SendId id);

  std::optional<SendId> newest(const Subject& subject) const;
  std::vector<SendId> overdue(Time now) const { return deadlines_.due(now); }
  Time next_deadline() const { return deadlines_.next(); }

 private:
  Deadlines<SendId> deadlines_;
  std::map<Subject, SendId> newest_;
  std::map<SendId, Subject> subject_of_;
};

}  // namespace adhoc_communication::transport
