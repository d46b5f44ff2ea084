#include "transport/send_terms.hpp"

namespace adhoc_communication::transport {

void SendTerms::expire_at(SendId id, Time deadline) { deadlines_.set(id, deadline); }

void SendTerms::make_newest(SendId id, const Subject& subject) {
  newest_[subject] = id;
  subject_of_[id] = subject;
}

void SendTerms::end(SendId id) {
  deadlines_.erase(id);
  const auto subject = subject_of_.find(id);
  if (subject == subject_of_.end()) return;
  const auto newest = newest_.find(subject->second);
  if (newest != newest_.end() && newest->second == id) newest_.erase(newest);
  subject_of_.erase(subject);
}

std::optional<SendId> SendTerms::newest(const Subject& subject) const {
  const auto found = newest_.find(subject);
  if (found == newest_.end()) return std::nullopt;
  return found->second;
}

}  // namespace adhoc_communication::transport
