// Frames of one priority that wait for one neighbour, apart for each robot that they came from.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "wire/frame_header.hpp"

namespace adhoc_communication::transport {

struct HopFrame {
  wire::FrameType type = wire::FrameType::kData;
  Bytes body;
  std::uint8_t priority = 0;
  MacAddress previous_hop{};  ///< from which it came; all zero for frames of this robot
  bool again = false;         ///< its content was sent before, in another frame
  bool held = false;          ///< it has waited for the repair of its route
  std::uint8_t beyond = 0;    ///< hops that data has to go when the neighbour has it
  std::uint8_t route = 0;     ///< hops of its whole way; 0: it takes no turns
  bool more = false;          ///< of its stream, another segment could follow at once
};

/// In the order in which they came from each. When full, whoever has most frames here loses the latest of them, so that
/// nobody keeps the others out.
class FrameQueue {
 public:
  static constexpr std::size_t kMostFrames = 2048;

  /// False when this frame is the one that is lost.
  bool push(HopFrame frame) {
    if (size_ >= kMostFrames && !make_room(frame.previous_hop)) return false;
    ++size_;
    by_hop_[frame.previous_hop].push_back(std::move(frame));
    return true;
  }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  bool has(const MacAddress& previous_hop) const { return by_hop_.count(previous_hop) != 0; }
  /// From whom frames wait.
  void add_hops(std::vector<MacAddress>& hops) const {
    for (const auto& [hop, frames] : by_hop_) hops.push_back(hop);
  }
  // Of these, has() holds.
  const HopFrame& first(const MacAddress& previous_hop) const { return by_hop_.at(previous_hop).front(); }
  HopFrame pop(const MacAddress& previous_hop) {
    const auto frames = by_hop_.find(previous_hop);
    HopFrame frame = std::move(frames->second.front());
    frames->second.pop_front();
    --size_;
    if (frames->second.empty()) by_hop_.erase(frames);
    return frame;
  }
  void move_all_to(std::vector<HopFrame>& out) {
    for (auto& [hop, frames] : by_hop_) std::move(frames.begin(), frames.end(), std::back_inserter(out));
    clear();
  }
  void clear() {
    by_hop_.clear();
    size_ = 0;
  }

 private:
  bool make_room(const MacAddress& newcomer) {
    const auto most = std::max_element(by_hop_.begin(), by_hop_.end(),
                                       [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
    const auto own = by_hop_.find(newcomer);
    if (own != by_hop_.end() && own->second.size() >= most->second.size()) return false;
    most->second.pop_back();
    --size_;
    return true;
  }

  std::map<MacAddress, std::deque<HopFrame>> by_hop_;
  std::size_t size_ = 0;
};

}  // namespace adhoc_communication::transport
