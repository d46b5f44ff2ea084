#include "air/schedule.hpp"

#include <algorithm>

#include "transport/data_count.hpp"

namespace adhoc_communication::air {

using wire::FrameType;

std::vector<SendId> Schedule::pump(Time now) {
  while (something_waits(now) && send_one(now)) {
  }
  return std::exchange(finished_, {});
}

bool Schedule::send_one(Time now) {
  for (std::uint8_t priority = 0; priority < transport::kPriorities; ++priority) {
    if (send_one(priority, now)) return true;
  }
  return false;
}

bool Schedule::send_one(std::uint8_t priority, Time now) {
  std::vector<MacAddress> hops = waiting_hops(priority);
  shares_[priority].sort(hops);
  for (const MacAddress& hop : hops) {
    const std::uint64_t before = statistics_.bytes_sent;
    if (!send_from(hop, priority, now)) continue;
    shares_[priority].charge(hop, statistics_.bytes_sent - before);
    return true;
  }
  return false;
}

/// The robots whose frames wait, each once; all zero is this one.
std::vector<MacAddress> Schedule::waiting_hops(std::uint8_t priority) const {
  std::vector<MacAddress> hops;
  hops_.add_waiting_hops(priority, hops);
  distributor_.add_waiting_hops(priority, hops);
  hops.push_back({});
  std::sort(hops.begin(), hops.end());
  hops.erase(std::unique(hops.begin(), hops.end()), hops.end());
  return hops;
}

bool Schedule::send_from(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  if (!distributor_.has_frame(priority)) return send_packet_frame(previous_hop, priority, now);
  std::vector<std::pair<MacAddress, bool>> kinds{{previous_hop, false}, {previous_hop, true}};
  group_shares_[priority].sort(kinds);
  for (const auto& kind : kinds) {
    const std::uint64_t before = statistics_.bytes_sent;
    const bool of_group = kind.second;
    if (!(of_group ? send_group_frame(previous_hop, priority, now) : send_packet_frame(previous_hop, priority, now))) {
      continue;
    }
    group_shares_[priority].charge(kind, statistics_.bytes_sent - before);
    return true;
  }
  return false;
}

/// What is lost is repeated before anything else of that robot.
bool Schedule::send_packet_frame(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  if (hops_.repeat_lost(priority, previous_hop, now)) return true;
  if (hops_.send_waiting(priority, previous_hop, now)) return true;
  if (previous_hop != MacAddress{}) return false;
  return send_broadcast(priority, now) || streams_.send_segment(priority, now);
}

bool Schedule::send_broadcast(std::uint8_t priority, Time now) {
  transport::BroadcastSender& broadcasts = broadcasts_[priority];
  if (!broadcasts.has_segment() || air_.ready_at() > now) return false;
  auto [data, finished] = broadcasts.next_segment();
  transmitter_.transmit(FrameType::kBroadcastData, wire::kEverybody, {0, 0, transmitter_.take_counter(), priority},
                        to_bytes(data), now);
  if (finished) finished_.push_back(*finished);
  return true;
}

/// As on a hop, of some frames a second follows the first without a gap, which measures the air; where they go to
/// another destination than before, the first two do.
bool Schedule::send_group_frame(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  const bool follows = transmitter_.next_counter() == last_group_counter_ + 1 && group_pair_ == 1;
  if (air_.ready_at() > now && !follows) return false;
  const auto before = follows ? std::optional(last_group_destination_) : std::nullopt;
  const auto frame = distributor_.next_frame(priority, previous_hop, before, now);
  if (!frame) return false;
  last_group_counter_ = transmitter_.take_counter();
  const bool same = std::exchange(last_group_destination_, frame->destination) == frame->destination;
  group_pair_ = same ? (group_pair_ + 1) % air_.pair_interval(frame->destination) : 1;
  transport::count(statistics_.group_data, previous_hop != MacAddress{}, frame->again);
  transmitter_.transmit(FrameType::kGroupData, frame->destination, {0, 0, last_group_counter_, priority}, frame->body,
                        now);
  return true;
}

Time Schedule::next_deadline(Time now) const {
  if (!something_waits(now)) return Time::max();
  return air_.ready_at() > now ? air_.ready_at() : air_.idle_at();
}

bool Schedule::something_waits(Time now) const {
  if (hops_.something_to_send(now)) return true;
  for (std::uint8_t priority = 0; priority < transport::kPriorities; ++priority) {
    if (broadcasts_[priority].has_segment() || distributor_.has_frame(priority)) return true;
  }
  return streams_.something_to_send(now);
}

}  // namespace adhoc_communication::air
