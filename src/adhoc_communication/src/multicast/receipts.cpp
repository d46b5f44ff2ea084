#include "multicast/receipts.hpp"

#include <algorithm>

#include "routing/sequence_number.hpp"

namespace adhoc_communication::multicast {
namespace {

bool is_news(const wire::GroupReceipt& receipt, const wire::GroupReceipt& known) {
  if (receipt.next != known.next) return static_cast<std::int32_t>(receipt.next - known.next) > 0;
  return (receipt.beyond & ~known.beyond) != 0;
}

bool goes_on_by_route(const wire::GroupReceipt& receipt, const wire::GroupReceipt& known) {
  return receipt.by_route && !known.by_route && receipt.next == known.next;
}

}  // namespace

void Receipts::owe(const wire::GroupReceipt& own, int hops, Time now) {
  const Time due = now + kStep * std::max(kDeepest - hops, 0) + random_.delay(kStep);
  own_due_[stream_of(own)] = due;
  keep(own, due, now);
}

void Receipts::pass_on(const wire::GroupReceipt& receipt, Time now) {
  const auto own = own_due_.find(stream_of(receipt));
  const Time due = now + random_.delay(kStep);
  keep(receipt, own == own_due_.end() ? due : std::max(due, own->second), now);
}

/// What was said before is not said again, so that nothing goes in circles; but once more by the route.
void Receipts::keep(const wire::GroupReceipt& receipt, Time due, Time now) {
  const Key key{stream_of(receipt), receipt.member};
  const auto known = kept_.find(key);
  if (known == kept_.end() && kept_.size() >= kMostKept) return;
  if (known != kept_.end() && !is_news(receipt, known->second.receipt) &&
      !goes_on_by_route(receipt, known->second.receipt)) {
    return;
  }
  Kept& kept = known == kept_.end() ? kept_[key] : known->second;
  const bool same_place = known != kept_.end() && kept.receipt.next == receipt.next;
  const std::uint32_t beyond = same_place ? kept.receipt.beyond | receipt.beyond : receipt.beyond;
  kept.receipt = receipt;
  kept.receipt.beyond = beyond;
  kept.due = std::min(kept.due, due);
  kept.heard = now;
  next_ = std::min(next_, kept.due);
}

void Receipts::link_lost(const MacAddress& neighbor, Time now) {
  for (auto& [key, kept] : kept_) {
    if (kept.told != neighbor || now - kept.told_at >= kSettled) continue;
    kept.told = {};
    kept.due = std::min(kept.due, now);
    next_ = std::min(next_, kept.due);
  }
}

std::optional<Receipts::Way> Receipts::way_to(const wire::GroupReceipt& receipt, Time now) const {
  const auto upstream = flooding_.upstream(receipt.root, receipt.root_boot);
  if (!receipt.by_route && upstream && neighbors_.two_way(*upstream, now)) return Way{*upstream, false};
  const routing::Route* route = router_.route_to(receipt.root, now);
  return route == nullptr ? std::nullopt : std::optional(Way{route->next_hop, true});
}

/// What is due soon goes along with what is due.
void Receipts::poll(Time now) {
  if (next_ > now) return;
  std::map<MacAddress, std::vector<Kept*>> by_way;
  for (auto& [key, kept] : kept_) {
    if (kept.due > now + kStep) continue;
    if (const auto way = way_to(kept.receipt, now)) {
      by_way[way->neighbor].push_back(&kept);
      kept.receipt.by_route = way->by_route;
    } else {
      kept.due = now - kept.heard < kSettled ? now + kAgain : Time::max();
    }
  }
  for (const auto& [neighbor, all] : by_way) {
    if (std::none_of(all.begin(), all.end(), [now](const Kept* kept) { return kept->due <= now; })) continue;
    std::vector<wire::GroupReceipt> receipts;
    for (Kept* kept : all) {
      kept->due = Time::max();
      kept->told = neighbor;
      kept->told_at = now;
      receipts.push_back(kept->receipt);
    }
    send(neighbor, receipts);
  }
  next_ = Time::max();
  for (const auto& [key, kept] : kept_) next_ = std::min(next_, kept.due);
}

void Receipts::send(const MacAddress& neighbor, const std::vector<wire::GroupReceipt>& receipts) {
  for (std::size_t begin = 0; begin < receipts.size(); begin += most_in_a_frame_) {
    const std::size_t end = std::min(begin + most_in_a_frame_, receipts.size());
    const auto from = receipts.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto to = receipts.begin() + static_cast<std::ptrdiff_t>(end);
    outbox_.unicast(neighbor, wire::FrameType::kGroupReceipts, to_bytes(wire::GroupReceipts{{from, to}}));
  }
}

void Receipts::expire(Time now) {
  for (auto kept = kept_.begin(); kept != kept_.end();) {
    const bool idle = kept->second.due == Time::max() && now - kept->second.heard >= kIdle;
    kept = idle ? kept_.erase(kept) : std::next(kept);
  }
  for (auto own = own_due_.begin(); own != own_due_.end();)
    own = own->second < now ? own_due_.erase(own) : std::next(own);
}

}  // namespace adhoc_communication::multicast
