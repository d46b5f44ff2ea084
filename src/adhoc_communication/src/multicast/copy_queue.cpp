#include "multicast/copy_queue.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace adhoc_communication::multicast {

void CopyQueue::add(WaitingCopy copy) {
  Line& line = lines_[copy.packet.stream];
  if (const auto served = line.served.find(copy.member); served != line.served.end()) {
    ++served->second;
    return line.ready.push_back(std::move(copy));
  }
  std::deque<WaitingCopy>& waiting = line.waiting[copy.member];
  if (waiting.empty()) line.turns.push_back(copy.member);
  waiting.push_back(std::move(copy));
  serve_next(line);
}

void CopyQueue::serve_next(Line& line) {
  while (line.served.size() < kMostServed && !line.turns.empty()) {
    auto copies = line.waiting.extract(line.turns.front());
    line.turns.pop_front();
    line.served[copies.key()] = copies.mapped().size();
    std::move(copies.mapped().begin(), copies.mapped().end(), std::back_inserter(line.ready));
  }
}

std::optional<WaitingCopy> CopyQueue::next() {
  for (Line& line : lines_) {
    if (line.ready.empty()) continue;
    WaitingCopy copy = std::move(line.ready.front());
    line.ready.pop_front();
    return copy;
  }
  return std::nullopt;
}

void CopyQueue::finished(const std::string& member, std::uint8_t stream) {
  Line& line = lines_[stream];
  const auto served = line.served.find(member);
  if (served == line.served.end() || --served->second > 0) return;
  line.served.erase(served);
  serve_next(line);
}

std::vector<WaitingCopy> CopyQueue::drop(SendId parent) {
  std::vector<WaitingCopy> dropped;
  const auto stays = [parent](const WaitingCopy& copy) {
    return copy.purpose != transport::Purpose::kFanOut || copy.parent != parent;
  };
  for (Line& line : lines_) {
    for (auto item = line.waiting.begin(); item != line.waiting.end();) {
      auto& [member, copies] = *item;
      const auto rest = std::stable_partition(copies.begin(), copies.end(), stays);
      std::move(rest, copies.end(), std::back_inserter(dropped));
      copies.erase(rest, copies.end());
      if (copies.empty()) line.turns.erase(std::find(line.turns.begin(), line.turns.end(), member));
      item = copies.empty() ? line.waiting.erase(item) : std::next(item);
    }
  }
  return dropped;
}

}  // namespace adhoc_communication::multicast
