#include "relay/lessons.hpp"

#include <iterator>

namespace adhoc_communication {

void Lessons::end(const std::string& destination, const TypeName& type, std::uint64_t transfer, bool delivered) {
  const auto found = under_way_.find({destination, type});
  if (found == under_way_.end() || found->second != transfer) return;
  under_way_.erase(found);
  if (known_.size() >= kMostKnown) known_.clear();
  if (delivered) known_.insert({destination, type});
}

void Lessons::forget(const std::string& destination) {
  for (auto known = known_.begin(); known != known_.end();) {
    known = known->first == destination ? known_.erase(known) : std::next(known);
  }
  for (auto lesson = under_way_.begin(); lesson != under_way_.end();) {
    lesson = lesson->first.first == destination ? under_way_.erase(lesson) : std::next(lesson);
  }
}

}  // namespace adhoc_communication
