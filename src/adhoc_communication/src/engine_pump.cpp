// What goes on the air next: the most urgent frame first, no more than the air can take.
#include <algorithm>

#include "engine_implementation.hpp"
#include "transport/data_count.hpp"

namespace adhoc_communication {

using wire::FrameType;

void Engine::Implementation::pump(Time now) {
  bool sent = true;
  while (sent) {
    sent = false;
    for (std::uint8_t priority = 0; priority < transport::kPriorities && !sent; ++priority) {
      sent = pump_priority(priority, now);
    }
  }
}

bool Engine::Implementation::pump_priority(std::uint8_t priority, Time now) {
  if (hops_.repeat_lost(priority, now)) return true;
  std::vector<MacAddress> hops = waiting_hops(priority);
  shares_[priority].sort(hops);
  for (const MacAddress& hop : hops) {
    const std::uint64_t before = statistics_.bytes_sent;
    if (!pump_hop(hop, priority, now)) continue;
    shares_[priority].charge(hop, statistics_.bytes_sent - before);
    return true;
  }
  return false;
}

/// The robots whose frames wait, each once; all zero is this one.
std::vector<MacAddress> Engine::Implementation::waiting_hops(std::uint8_t priority) const {
  std::vector<MacAddress> hops;
  hops_.add_waiting_hops(priority, hops);
  distributor_.add_waiting_hops(priority, hops);
  hops.push_back({});
  std::sort(hops.begin(), hops.end());
  hops.erase(std::unique(hops.begin(), hops.end()), hops.end());
  return hops;
}

bool Engine::Implementation::pump_hop(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  if (!distributor_.has_frame(priority)) return pump_frames(previous_hop, priority, now);
  std::vector<std::pair<MacAddress, bool>> kinds{{previous_hop, false}, {previous_hop, true}};
  group_shares_[priority].sort(kinds);
  for (const auto& kind : kinds) {
    const std::uint64_t before = statistics_.bytes_sent;
    const bool of_group = kind.second;
    if (!(of_group ? pump_groups(previous_hop, priority, now) : pump_frames(previous_hop, priority, now))) continue;
    group_shares_[priority].charge(kind, statistics_.bytes_sent - before);
    return true;
  }
  return false;
}

/// One neighbour after the other.
bool Engine::Implementation::pump_frames(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  const bool passed_on = hops_.send_waiting(priority, previous_hop, now);
  if (passed_on || previous_hop != MacAddress{}) return passed_on;
  return pump_broadcasts(priority, now) || streams_.send_segment(priority, now);
}

bool Engine::Implementation::pump_broadcasts(std::uint8_t priority, Time now) {
  transport::BroadcastSender& broadcasts = broadcasts_[priority];
  if (!broadcasts.has_segment() || air_.ready_at() > now) return false;
  auto [data, finished] = broadcasts.next_segment();
  hops_.broadcast(FrameType::kBroadcastData, to_bytes(data), now);
  if (finished) finish(*finished, true, {}, now);
  return true;
}

/// As on a link, of some frames a second follows the first without a gap, which measures the air; where they go to
/// another destination than before, the first two do.
bool Engine::Implementation::pump_groups(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  const bool follows = transmitter_.next_counter() == last_group_counter_ + 1 && group_pair_ == 1;
  if (air_.ready_at() > now && !follows) return false;
  const auto before = follows ? std::optional(last_group_destination_) : std::nullopt;
  const auto frame = distributor_.next_frame(priority, previous_hop, before, now);
  if (!frame) return false;
  last_group_counter_ = transmitter_.take_counter();
  const bool same = std::exchange(last_group_destination_, frame->destination) == frame->destination;
  group_pair_ =
      same ? (group_pair_ + 1) % (air_.calibrated(frame->destination) ? transport::AirClock::kPairInterval : 2) : 1;
  transport::count(statistics_.group_data, previous_hop != MacAddress{}, frame->again);
  transmitter_.transmit(FrameType::kGroupData, frame->destination, {0, 0, last_group_counter_}, frame->body, now);
  return true;
}

/// Whether pump() would send more if the air were free.
bool Engine::Implementation::something_to_send() const {
  if (hops_.something_to_send()) return true;
  for (std::uint8_t priority = 0; priority < transport::kPriorities; ++priority) {
    if (broadcasts_[priority].has_segment() || distributor_.has_frame(priority)) return true;
  }
  return streams_.something_to_send();
}

}  // namespace adhoc_communication
