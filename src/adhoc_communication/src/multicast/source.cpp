#include "multicast/source.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {
namespace {

bool is_little(const Transfer& transfer) {
  return transfer.packet->total() <= Source::kFewFrames * std::size_t{transfer.packet->segment_size()};
}

}  // namespace

std::set<MacAddress> Source::awaiting(const Branch& own) {
  std::set<MacAddress> members;
  for (const GroupStream& stream : own.streams) {
    for (const auto& [number, transfer] : stream.transfers) {
      if (!transfer.flooded) members.insert(transfer.open.begin(), transfer.open.end());
    }
  }
  return members;
}

bool Source::wants_fresh_tree(const Branch& own) const {
  if (own.tree.epoch == 0) return true;
  bool burdened = false;
  for (std::size_t stream = 0; stream < own.streams.size(); ++stream) {
    const auto& transfers = own.streams[stream].transfers;
    const auto oldest =
        std::find_if(transfers.begin(), transfers.end(), [](const auto& item) { return !item.second.flooded; });
    burdened = burdened || (oldest != transfers.end() && before(oldest->first, built_before_[stream]));
  }
  return stale_ && !burdened;
}

std::set<MacAddress> Source::fresh_tree(const Branch& own, std::set<MacAddress> members, Time now) {
  members.merge(awaiting(own));
  built(own, members, now);
  return members;
}

std::optional<std::set<MacAddress>> Source::wants_tree_anew(const Branch& own, Time now) {
  if (!std::exchange(build_anew_, false)) return std::nullopt;
  std::set<MacAddress> members = awaiting(own);
  for (const auto& [child, behind] : own.tree.children) members.insert(behind.begin(), behind.end());
  built(own, members, now);
  return members;
}

void Source::built(const Branch& own, const std::set<MacAddress>& members, Time now) {
  built_at_ = now;
  for (std::size_t stream = 0; stream < own.streams.size(); ++stream) built_before_[stream] = own.streams[stream].next;
  stale_ = false;
  left_out_.clear();
  untried_ = members;
}

std::uint32_t Source::start(Branch& own, SendId id, Priority priority, transport::Image image,
                            const std::set<MacAddress>& members, Time now) {
  GroupStream& stream = own.streams[static_cast<std::size_t>(priority)];
  const std::uint32_t number = stream.next++;
  if (members.empty()) return number;
  Transfer& transfer = stream.transfers[number];
  begin(own, transfer, id, std::move(image), now);
  transfer.open = members;
  return number;
}

bool Source::may_flood(const Branch& own, Priority priority) const {
  const auto& transfers = own.streams[static_cast<std::size_t>(priority)].transfers;
  const auto flooded =
      std::count_if(transfers.begin(), transfers.end(), [](const auto& item) { return item.second.flooded; });
  return static_cast<std::size_t>(flooded) < kMostFlooded;
}

wire::GroupData Source::start_flooded(Branch& own, SendId id, Priority priority, transport::Image image,
                                      const std::set<MacAddress>& members, Time now) {
  GroupStream& stream = own.streams[static_cast<std::size_t>(priority)];
  const std::uint32_t number = stream.next++;
  Transfer& transfer = stream.transfers[number];
  transfer.packet = std::make_unique<GroupPacket>(*image, segment_size_);
  transfer.to_children = std::make_unique<Distribution>(*transfer.packet, own.round_trip, first_parity_);
  transfer.flooded = true;
  transfer.id = id;
  transfer.image = std::move(image);
  transfer.open = members;
  transfer.last_news = transfer.sent = now;
  transfer.late = now + flood_times_.timeout();
  next_late_ = std::min(next_late_, transfer.late);
  wire::GroupData data;
  data.root_boot = own.tree.boot;
  data.stream = static_cast<std::uint8_t>(priority);
  data.flooded = true;
  data.packet = number;
  data.base = oldest_open(own, data.stream);
  data.total = transfer.packet->total();
  data.segment_size = segment_size_;
  data.octets = *transfer.image;
  return data;
}

void Source::receipt(Branch& own, const wire::GroupReceipt& receipt, Time now) {
  const std::pair key(receipt.member, receipt.stream);
  if (receipts_.size() < kMostReceipts || receipts_.count(key) != 0) receipts_[key] = receipt;
  flood_times_.told(receipt, now);
  for (auto& [number, transfer] : own.streams[receipt.stream].transfers) {
    if (transfer.flooded && transfer.open.count(receipt.member) != 0) reached_by_flood(transfer, number, receipt, now);
  }
}

void Source::reached_by_flood(Transfer& transfer, std::uint32_t number, const wire::GroupReceipt& receipt, Time now) {
  const Had state = had(receipt, number);
  if (state == Had::kNot) return missed_by_flood(transfer, number, receipt, now);
  if (transfer.there.count(receipt.member) == 0) flood_times_.sample(now - transfer.sent);
  if (state == Had::kWaits) {
    transfer.there.insert(receipt.member);
  } else {
    finish_member(transfer, {transfer.id, receipt.member, true, false, {}});
  }
}

bool Source::has_delivered(const MacAddress& member, std::uint8_t stream, std::uint32_t number) const {
  const auto found = receipts_.find({member, stream});
  return found != receipts_.end() && had(found->second, number) == Had::kDelivered;
}

void Source::forget_receipts(const MacAddress& member) {
  for (std::uint8_t stream = 0; stream < transport::kPriorities; ++stream) {
    receipts_.erase({member, stream});
    handed_over_.erase({member, stream});
  }
}

/// Packets come in order, more or less: with a later one there, it will hardly come any more.
void Source::missed_by_flood(Transfer& transfer, std::uint32_t number, const wire::GroupReceipt& receipt, Time now) {
  const std::uint32_t ahead = number - receipt.next;  // 0: it is the one that is waited for
  if (ahead > 31 || receipt.beyond >> ahead == 0) return;
  if (transfer.missed.emplace(receipt.member, now).second) next_late_ = std::min(next_late_, now + kMissed);
}

void Source::serve_late(Branch& own, Time now) {
  if (next_late_ > now) return;
  next_late_ = Time::max();
  for (std::uint8_t stream = 0; stream < own.streams.size(); ++stream) {
    std::set<MacAddress> behind;
    for (auto& [number, transfer] : own.streams[stream].transfers) {
      if (transfer.flooded) end_late({stream, number}, transfer, behind, now);
      behind.insert(transfer.open.begin(), transfer.open.end());
    }
  }
}

/// The packet is at the member, and waits for one before it; its own copy would bring nothing.
bool Source::waits(const Transfer& transfer, const MacAddress& member, PacketNumber packet, Time now) const {
  if (transfer.there.count(member) == 0 || now - transfer.sent >= kCopyTakes) return false;
  if (now - transfer.sent < kWaits) return true;
  const auto copy = handed_over_.find({member, packet.stream});
  return copy != handed_over_.end() && before(copy->second, packet.number) &&
         !has_delivered(member, packet.stream, copy->second);
}

void Source::hand_over(const MacAddress& member, PacketNumber packet) {
  const MemberStream key(member, packet.stream);
  if (handed_over_.size() < kMostReceipts || handed_over_.count(key) != 0) handed_over_[key] = packet.number;
}

/// A copy says that nothing before it will come any more: to members with an earlier packet on its way none is sent.
void Source::end_late(PacketNumber packet, Transfer& transfer, const std::set<MacAddress>& behind, Time now) {
  const bool all = transfer.late <= now;
  const std::set<MacAddress> open = transfer.open;
  for (const MacAddress& member : open) {
    const auto missed = transfer.missed.find(member);
    const bool has_missed = missed != transfer.missed.end() && missed->second + kMissed <= now;
    if (!(all || has_missed) || behind.count(member) != 0 || waits(transfer, member, packet, now)) continue;
    if (transfer.there.count(member) == 0) flood_times_.given_up(member, packet, transfer.sent);
    hand_over(member, packet);
    finish_member(transfer, {transfer.id, member, false, true, "it did not say that it has got it", true});
  }
  if (all) transfer.late = now + flood_times_.timeout();
  if (!transfer.open.empty()) next_late_ = std::min(next_late_, transfer.late);
  for (const auto& [member, since] : transfer.missed) {
    if (since + kMissed > now) next_late_ = std::min(next_late_, since + kMissed);
  }
}

void Source::copy_arrived(Branch& own, const MacAddress& member, PacketNumber packet, Time now) {
  flood_times_.copied(member, packet);
  const auto known = receipts_.find({member, packet.stream});
  if (known == receipts_.end() || before(packet.number, known->second.next)) return;
  receipt(own, with_delivered(known->second, packet.number), now);
}

void Source::begin(Branch& own, Transfer& transfer, SendId id, transport::Image image, Time now) {
  transfer.to_children.reset();  // before the packet that it refers to
  transfer.packet = std::make_unique<GroupPacket>(*image, segment_size_);
  transfer.to_children = std::make_unique<Distribution>(*transfer.packet, own.round_trip, first_parity_);
  transfer.to_children->set_children(own.tree.coverages(), true, now);
  transfer.hops = 0;
  transfer.id = id;
  transfer.image = std::move(image);
  transfer.last_news = now;
}

std::optional<std::uint32_t> Source::replace(Branch& own, SendId former, SendId id, const transport::Image& image,
                                             const std::set<MacAddress>& members, Time now) {
  // Of one member it has ended already: the count of the rest is the former's.
  const auto is_former = [&](const MemberEnd& end) { return end.id == former; };
  if (std::any_of(ends_.begin(), ends_.end(), is_former)) return std::nullopt;
  for (std::size_t priority = 0; priority < own.streams.size(); ++priority) {
    for (auto& [number, transfer] : own.streams[priority].transfers) {
      if (transfer.id != former) continue;
      if (transfer.flooded || transfer.to_children->begun() || copies_[priority].count(number) != 0)
        return std::nullopt;
      if (!std::includes(transfer.open.begin(), transfer.open.end(), members.begin(), members.end())) {
        return std::nullopt;
      }
      begin(own, transfer, id, image, now);
      own.busy = true;
      return number;
    }
  }
  return std::nullopt;
}

std::set<MacAddress> Source::drop(Branch& own, SendId id) {
  for (GroupStream& stream : own.streams) {
    for (auto& [number, transfer] : stream.transfers) {
      if (transfer.id == id) return std::exchange(transfer.open, {});
    }
  }
  return {};
}

void Source::finish_member(Transfer& transfer, const MemberEnd& end) {
  if (transfer.open.erase(end.member) != 0) ends_.push_back(end);
}

void Source::give_up(Branch& own, const MacAddress& member, bool by_copy, const std::string& reason) {
  refusals_.erase(member);
  for (GroupStream& stream : own.streams) {
    for (auto& [number, transfer] : stream.transfers) {
      finish_member(transfer, {transfer.id, member, false, by_copy, reason});
    }
  }
}

void Source::drop_member(Branch& own, const MacAddress& member, const std::string& reason) {
  give_up(own, member, false, reason);
  for (std::uint8_t stream = 0; stream < transport::kPriorities; ++stream) handed_over_.erase({member, stream});
}

void Source::reached(Transfer& transfer, const std::set<MacAddress>& members) {
  for (const MacAddress& member : members) {
    refusals_.erase(member);
    untried_.erase(member);
    finish_member(transfer, {transfer.id, member, true, false, {}});
  }
}

/// Once is bad luck, and a new tree gets there; a member refused again is served by itself. To be served by itself with
/// a few frames costs less than a new tree.
void Source::left_over(Branch& own, const LeftOver& left_over, Time now) {
  for (const MacAddress& member : left_over.members) {
    if (left_over.final) {
      give_up(own, member, false, left_over.reason);
      continue;
    }
    const Awaited waiting = awaited(own, member);
    if (waiting == Awaited::kNothing) continue;  // the next packet for it looks for a way anew
    if (waiting == Awaited::kLittle) refused_with_little(member, now);
    if (waiting == Awaited::kLittle || ++refusals_[member] >= kMostRefusals) {
      give_up(own, member, true, left_over.reason);
    } else {
      build_anew_ = true;
    }
  }
}

void Source::refused_with_little(const MacAddress& member, Time now) {
  if (untried_.erase(member) != 0) {
    left_out_.insert(member);
  } else if (left_out_.count(member) == 0 || now - built_at_ >= kLeftOut) {
    stale_ = true;
  }
}

/// What still has to reach the member.
Source::Awaited Source::awaited(const Branch& own, const MacAddress& member) {
  Awaited most = Awaited::kNothing;
  for (const GroupStream& stream : own.streams) {
    for (const auto& [number, transfer] : stream.transfers) {
      if (!transfer.flooded && transfer.open.count(member) != 0)
        most = std::max(most, is_little(transfer) ? Awaited::kLittle : Awaited::kMuch);
    }
  }
  return most;
}

void Source::copy_finished(std::uint8_t stream, std::uint32_t number) {
  auto& copies = copies_[stream];
  if (const auto found = copies.find(number); found != copies.end()) copies.erase(found);
}

std::uint32_t Source::oldest_open(const Branch& own, std::uint8_t stream) const {
  const GroupStream& packets = own.streams[stream];
  const auto& copies = copies_[stream];
  const std::uint32_t oldest = packets.transfers.empty() ? packets.next : packets.transfers.begin()->first;
  return !copies.empty() && before(*copies.begin(), oldest) ? *copies.begin() : oldest;
}

void Source::remove_finished(Branch& own) {
  for (GroupStream& stream : own.streams) {
    for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
      transfer = transfer->second.open.empty() ? stream.transfers.erase(transfer) : std::next(transfer);
    }
  }
}

}  // namespace adhoc_communication::multicast
