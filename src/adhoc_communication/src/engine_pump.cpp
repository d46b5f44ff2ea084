// What goes on the air next: the most urgent frame first, no more than the air can take.
#include <algorithm>

#include "engine_implementation.hpp"
#include "round_robin.hpp"

namespace adhoc_communication {

using transport::HopSender;
using wire::FrameType;

namespace {

constexpr Time kLongestBacklog = std::chrono::milliseconds(20);
constexpr int kPairInterval = 64;  ///< of so many frames to a neighbour, two measure the air

}  // namespace

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
  if (pump_repetitions(priority, now)) return true;
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
  for (const auto& [neighbor, link] : links_.busy()) link->sender.add_waiting_hops(priority, hops);
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
  const bool passed_on = visit_after(links_.busy(), last_link_served_, [&](const auto& item) {
    return pump_link(item.first, *item.second, priority, previous_hop, now);
  });
  if (passed_on || previous_hop != MacAddress{}) return passed_on;
  return pump_broadcasts(priority, now) || pump_streams(priority, now);
}

bool Engine::Implementation::pump_broadcasts(std::uint8_t priority, Time now) {
  transport::BroadcastSender& broadcasts = broadcasts_[priority];
  if (!broadcasts.has_segment() || air_.ready_at() > now) return false;
  auto [data, finished] = broadcasts.next_segment();
  broadcast(FrameType::kBroadcastData, to_bytes(data));
  if (finished) finish(*finished, true, {}, now);
  return true;
}

bool Engine::Implementation::pump_repetitions(std::uint8_t priority, Time now) {
  return visit_after(links_.busy(), last_link_served_, [&](const auto& item) {
    Link& link = *item.second;
    if (!link.sender.has_resend(priority) || !link.sender.may_resend() || !air_allows(item.first, link, now))
      return false;
    last_link_served_ = item.first;
    const std::uint64_t counter = next_counter_++;
    send_on(item.first, link, link.sender.resend(priority, counter, now), counter, now);
    return true;
  });
}

bool Engine::Implementation::pump_link(const MacAddress& neighbor, Link& link, std::uint8_t priority,
                                       const MacAddress& previous_hop, Time now) {
  if (!link.sender.has_waiting(priority, previous_hop) || !link.sender.may_start() ||
      !air_allows(neighbor, link, now)) {
    return false;
  }
  last_link_served_ = neighbor;
  transport::HopFrame frame = link.sender.take_waiting(priority, previous_hop);
  if (options_.num_link_retrans == 0) {
    send_unacknowledged(neighbor, frame, now);
    return true;
  }
  const std::uint64_t counter = next_counter_++;
  send_on(neighbor, link, link.sender.start(std::move(frame), counter, now), counter, now);
  return true;
}

/// As on a link, of some frames a second follows the first without a gap, which measures the air; where they go to
/// another destination than before, the first two do.
bool Engine::Implementation::pump_groups(const MacAddress& previous_hop, std::uint8_t priority, Time now) {
  const bool follows = next_counter_ == last_group_counter_ + 1 && group_pair_ == 1;
  if (air_.ready_at() > now && !follows) return false;
  const auto before = follows ? std::optional(last_group_destination_) : std::nullopt;
  const auto frame = distributor_.next_frame(priority, previous_hop, before, now);
  if (!frame) return false;
  last_group_counter_ = next_counter_++;
  const bool same = std::exchange(last_group_destination_, frame->destination) == frame->destination;
  group_pair_ = same ? (group_pair_ + 1) % (air_.calibrated(frame->destination) ? kPairInterval : 2) : 1;
  count_data(statistics_.group_data, previous_hop != MacAddress{}, frame->again);
  transmit(FrameType::kGroupData, 0, frame->destination, 0, last_group_counter_, frame->body, now);
  return true;
}

/// Own packets, one destination after the other.
bool Engine::Implementation::pump_streams(std::uint8_t priority, Time now) {
  return visit_after(streams_.busy(), last_stream_served_, [&](const auto& item) {
    return item.first.second == priority && pump_stream(item.first, *item.second, now);
  });
}

bool Engine::Implementation::pump_stream(const StreamKey& key, Stream& stream, Time now) {
  if (!stream.next_hop || !stream.sender.has_segment()) return false;
  Link& hop = link(*stream.next_hop);
  if (!hop.sender.may_start() || !air_allows(*stream.next_hop, hop, now)) return false;
  last_stream_served_ = key;
  const bool again = stream.sender.repeats();
  wire::Data data = stream.sender.next_segment(now);
  data.source = self_.address;
  data.source_boot = self_.boot;
  data.destination = *stream.address;
  router_.used(self_.address, data.destination, self_.address, now);
  transport::HopFrame frame{FrameType::kData, to_bytes(data), key.second, {}, again};
  if (options_.num_link_retrans == 0) {
    send_unacknowledged(*stream.next_hop, frame, now);
    return true;
  }
  const std::uint64_t counter = next_counter_++;
  send_on(*stream.next_hop, hop, hop.sender.start(std::move(frame), counter, now), counter, now);
  return true;
}

/// Two frames may be on their way to each neighbour even if the air is believed to be slow, as long as that is not for
/// long. Of a pair that measures the air, the first waits until the radio is idle and the second follows at once, so
/// that no more is in its hands than otherwise.
bool Engine::Implementation::air_allows(const MacAddress& neighbor, const Link& link, Time now) const {
  const bool pair_begins = air_.calibrated(neighbor) && link.pair == kPairInterval - 1;
  if (pair_begins && air_.idle_at() > now && air_.idle_at() <= now + kLongestBacklog) return false;
  if (air_.ready_at() <= now) return true;
  if (options_.num_link_retrans == 0) return false;
  return link.pair == 0 || (link.sender.unresolved() < 2 && air_.ready_at() <= now + kLongestBacklog);
}

void Engine::Implementation::send_on(const MacAddress& neighbor, Link& link, const HopSender::Outgoing& outgoing,
                                     std::uint64_t counter, Time now) {
  std::uint8_t flags = wire::kWantsAcknowledgment;
  const bool calibrated = air_.calibrated(neighbor);
  link.pair = (link.pair + 1) % (calibrated ? kPairInterval : 2);
  if (!calibrated || link.sender.pressing() || link.pair == 1) flags |= wire::kAcknowledgeNow;
  if (outgoing.type == FrameType::kData) count_data(statistics_.unicast_data, outgoing.passed_on, outgoing.again);
  transmit(outgoing.type, flags, neighbor, outgoing.link_sequence, counter, *outgoing.body, now);
}

/// With the repetition on each hop switched off, frames carry no link sequence and nobody acknowledges them.
void Engine::Implementation::send_unacknowledged(const MacAddress& neighbor, const transport::HopFrame& frame,
                                                 Time now) {
  if (frame.type == FrameType::kData) {
    count_data(statistics_.unicast_data, frame.previous_hop != MacAddress{}, frame.again);
  }
  transmit(frame.type, 0, neighbor, 0, next_counter_++, frame.body, now);
}

/// Whether pump() would send more if the air were free.
bool Engine::Implementation::something_to_send() const {
  for (const auto& [neighbor, link] : links_.busy()) {
    for (std::uint8_t priority = 0; priority < transport::kPriorities; ++priority) {
      if (link->sender.has_resend(priority) && link->sender.may_resend()) return true;
      if (link->sender.has_waiting(priority) && link->sender.may_start()) return true;
    }
  }
  for (std::uint8_t priority = 0; priority < transport::kPriorities; ++priority) {
    if (broadcasts_[priority].has_segment() || distributor_.has_frame(priority)) return true;
  }
  return std::any_of(streams_.busy().begin(), streams_.busy().end(), [&](const auto& item) {
    const Stream& stream = *item.second;
    if (!stream.next_hop || !stream.sender.has_segment()) return false;
    const Link* hop = links_.find(*stream.next_hop);
    return hop == nullptr || hop->sender.may_start();
  });
}

}  // namespace adhoc_communication
