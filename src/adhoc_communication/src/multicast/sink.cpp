#include "multicast/sink.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {

using wire::FrameType;

void Sink::evicted(Branch& branch, const transport::Reassembly::Key& key) {
  const auto stream = static_cast<std::uint8_t>(key.carrier - transport::Reassembly::kGroup);
  auto& transfers = branch.streams[stream].transfers;
  if (const auto found = transfers.find(key.packet); found != transfers.end()) {
    forget({key.source, branch, stream, key.packet, found->second});
  }
}

bool Sink::on_data(const MacAddress& from, std::uint64_t counter, const wire::GroupData& data, Branch* branch,
                   Time now) {
  const bool question = data.octets.empty();
  if (branch == nullptr || (question && branch->tree.upstream != from)) {
    if (question) disown(from, data);
    return false;
  }
  branch->tree.last_used = now;
  const bool from_upstream = branch->tree.upstream == from;
  if (from_upstream) {
    branch->tree.heard_above = now;
    measure(*branch, counter, data.follows, now);
    pass_over(data.root, branch->streams[data.stream], data.base);
  }
  if (is_done_with(*branch, data)) {
    if (from_upstream && data.report) tell_done(branch->tree, data);
    return false;
  }
  Transfer* transfer = transfer_for(*branch, data, now);
  if (transfer == nullptr) return false;
  transfer->last_news = now;
  const bool of_use = !question && transfer->packet->take(data.block, data.symbol, data.octets);
  if (of_use) {
    made_progress(*transfer, data.octets.size(), now);
    deliver(data.root, branch->streams[data.stream]);
  }
  if (!from_upstream || !data.report) return of_use;
  transfer->round = std::max(transfer->round, data.round);
  if (question) {
    report({data.root, *branch, data.stream, data.packet, *transfer}, true, now);
  } else {
    transfer->report_due = now + random_.delay(kReportJitter);
  }
  return of_use;
}

bool Sink::on_flooded(const wire::GroupData& data, Branch& branch, Time now) {
  branch.tree.last_used = now;
  GroupStream& stream = branch.streams[data.stream];
  stream.flood_hops = data.hops;
  begin(data.root, stream, data.base);
  pass_over(data.root, stream, data.base);
  if (before(data.packet, stream.next)) return false;
  Transfer* transfer = transfer_for(branch, data, now);
  if (transfer == nullptr || !transfer->packet->take(0, 0, data.octets)) return false;
  transfer->last_news = now;
  made_progress(*transfer, data.octets.size(), now);
  deliver(data.root, stream);
  return true;
}

/// The rhythm of frames that follow one another without a gap tells how fast the air is.
void Sink::measure(Branch& branch, std::uint64_t counter, bool follows, Time now) {
  if (follows && counter == branch.last_counter + 1) {
    branch.measured_counter = counter;
    branch.spacing = now - branch.last_arrival;
  }
  branch.last_counter = counter;
  branch.last_arrival = now;
}

void Sink::made_progress(const Transfer& transfer, std::size_t octets, Time now) {
  if (!transfer.room) return;
  transfer.room->progress(octets, now);
  if (transfer.packet->complete()) transfer.room->complete(false, now);
}

void Sink::passed_on(const Transfer& transfer, Time now) {
  if (transfer.room) transfer.room->progress(0, now);
}

Transfer* Sink::transfer_for(Branch& branch, const wire::GroupData& data, Time now) {
  GroupStream& stream = branch.streams[data.stream];
  if (branch.tree.upstream) begin(data.root, stream, data.base);
  const auto found = stream.transfers.find(data.packet);
  if (found == stream.transfers.end()) return admit(branch, data, now);
  const GroupPacket& packet = *found->second.packet;
  const bool same = packet.total() == data.total && packet.segment_size() == data.segment_size;
  return same ? &found->second : nullptr;
}

void Sink::begin(const MacAddress& root, GroupStream& stream, std::uint32_t base) {
  const bool first = !stream.base;
  if (first) {
    stream.base = base;
    stream.early.reset();
    for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
      const bool ahead = transfer->first - base < kPacketsAhead;
      transfer = ahead ? std::next(transfer) : stream.transfers.erase(transfer);
    }
  }
  if (!std::exchange(stream.started, true)) {
    stream.next = base;
  } else if (first) {
    skip_to(root, stream, base);  // copies had come before
  } else {
    return;
  }
  deliver(root, stream);
}

Transfer* Sink::admit(Branch& branch, const wire::GroupData& data, Time now) {
  const Tree& tree = branch.tree;
  GroupStream& stream = branch.streams[data.stream];
  if (data.total > largest_packet_) return nullptr;
  if (!stream.base && !stream.early) stream.early = data.base;
  if (data.packet - (stream.base ? *stream.base : *stream.early) >= kPacketsAhead) return nullptr;
  const auto carrier = static_cast<std::uint8_t>(transport::Reassembly::kGroup + data.stream);
  const transport::Reassembly::Key room{data.root, tree.boot, carrier, data.packet};
  if (!has_place(data.root, branch, data.stream) ||
      !reassembly_.admit(room, data.total, stream.started && data.packet == stream.next, now)) {
    if (!data.flooded) tell_no_room(tree, data, stream, now);
    return nullptr;
  }
  Transfer& transfer = stream.transfers[data.packet];
  transfer.room = std::make_unique<Room>(reassembly_, room);
  transfer.packet = std::make_unique<GroupPacket>(data.total, data.segment_size);
  transfer.to_children = std::make_unique<Distribution>(*transfer.packet, branch.round_trip, first_parity_);
  transfer.hops = data.hops;
  transfer.flooded = data.flooded;
  if (data.flooded) return &transfer;
  transfer.to_children->set_children(tree.coverages(), true, now);
  if (!tree.upstream) return &transfer;
  for (const auto& [child, members] : tree.children) {
    for (const MacAddress& member : members) router_.used(data.root, member, *tree.upstream, now);
  }
  return &transfer;
}

/// A packet that some other member has still to get keeps the root from going on; those behind it that are done with
/// here must not keep out further ones.
bool Sink::has_place(const MacAddress& root, Branch& branch, std::uint8_t stream) {
  auto& transfers = branch.streams[stream].transfers;
  if (transfers.size() < kMostTransfers) return true;
  const auto done_with = std::find_if(transfers.begin(), transfers.end(), [&](auto& entry) {
    return entry.second.told && settled({root, branch, stream, entry.first, entry.second});
  });
  if (done_with == transfers.end()) return false;
  forget({root, branch, stream, done_with->first, done_with->second});
  return true;
}

/// Of a packet that was done with, it is remembered what upstream was told, and for whom that holds.
void Sink::forget(const Place& place) {
  GroupStream& stream = place.branch.streams[place.stream];
  if (place.transfer.told && settled(place)) {
    stream.done.emplace_back(place.number, *place.transfer.told);
    if (stream.done.size() > kMostDone) stream.done.erase(stream.done.begin());
  }
  stream.transfers.erase(place.number);
}

/// Delivered here and forgotten, with nobody behind this robot who might miss it. Where there are others behind it by
/// now, the packet is taken anew.
bool Sink::is_done_with(Branch& branch, const wire::GroupData& data) const {
  GroupStream& stream = branch.streams[data.stream];
  const auto done = std::find_if(stream.done.begin(), stream.done.end(),
                                 [&](const auto& entry) { return entry.first == data.packet; });
  if (done == stream.done.end()) return false;
  const Tree& tree = branch.tree;
  const bool nobody_behind = tree.children.empty() && tree.unrouted.empty();
  if (nobody_behind || done->second == Told{tree.epoch, tree.own_coverage(self_.address)}) return true;
  stream.done.erase(done);
  return false;
}

/// Until there is room, the upstream neighbour keeps its frames and asks now and then.
void Sink::tell_no_room(const Tree& tree, const wire::GroupData& data, GroupStream& stream, Time now) {
  if (!tree.upstream) return;
  const bool question = data.octets.empty();
  if (!question && now - stream.told_no_room < kNoRoomInterval) return;
  stream.told_no_room = now;
  wire::GroupReport report = report_on(tree, data);
  report.first_block = wire::kNoRoom;
  outbox_.unicast(*tree.upstream, FrameType::kGroupReport, to_bytes(report));
}

void Sink::tell_done(const Tree& tree, const wire::GroupData& data) {
  wire::GroupReport report = report_on(tree, data);
  report.complete = true;
  report.first_block = static_cast<std::uint16_t>(GroupPacket::count_blocks(data.total, data.segment_size));
  outbox_.unicast(*tree.upstream, FrameType::kGroupReport, to_bytes(report));
}

/// On a packet that has no place here.
wire::GroupReport Sink::report_on(const Tree& tree, const wire::GroupData& data) const {
  wire::GroupReport report;
  report.root = data.root;
  report.root_boot = data.root_boot;
  report.stream = data.stream;
  report.packet = data.packet;
  report.epoch = tree.epoch;
  report.round = data.round;
  report.coverage = tree.own_coverage(self_.address);
  return report;
}

/// The root has finished the packets before `base`: with what did not get here by then it has given up.
void Sink::pass_over(const MacAddress& root, GroupStream& stream, std::uint32_t base) {
  if (!stream.started || (stream.base && !before(*stream.base, base))) return;
  stream.base = base;
  skip_to(root, stream, base);
  for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
    const auto candidate = transfer++;
    if (before(candidate->first, base)) stream.transfers.erase(candidate);
  }
  const auto passed = [base](const auto& entry) { return before(entry.first, base); };
  stream.done.erase(std::remove_if(stream.done.begin(), stream.done.end(), passed), stream.done.end());
  deliver(root, stream);
}

/// What is missing before `number` will not come any more.
void Sink::skip_to(const MacAddress& root, GroupStream& stream, std::uint32_t number) {
  while (before(stream.next, number)) {
    const auto found = stream.transfers.find(stream.next);
    if (found == stream.transfers.end() || !found->second.packet->complete()) {
      // Nothing between two packets that are here: a long gap is not walked through.
      const auto later = stream.transfers.upper_bound(stream.next);
      stream.next = later == stream.transfers.end() || before(number, later->first) ? number : later->first;
    } else {
      deliver(root, stream);
    }
  }
}

void Sink::deliver(const MacAddress& root, GroupStream& stream) {
  while (stream.started) {
    const auto found = stream.transfers.find(stream.next);
    if (found == stream.transfers.end() || !found->second.packet->complete()) return;
    arrived_.push_back({root, found->second.packet->image(), found->second.hops});
    ++stream.next;
  }
}

void Sink::take_copy(const MacAddress& root, Branch& branch, std::uint8_t stream_number, std::uint32_t number,
                     const Bytes& image, Time now) {
  branch.tree.last_used = now;
  GroupStream& stream = branch.streams[stream_number];
  if (!std::exchange(stream.started, true)) stream.next = number;
  if (before(number, stream.next)) return;
  // Copies come in order: all before this one have come, or never will. That says nothing of robots behind this one.
  skip_to(root, stream, number);
  if (before(number, stream.next)) return;
  arrived_.push_back({root, image, 1});
  const auto found = stream.transfers.find(number);
  if (found != stream.transfers.end() && found->second.packet->fill(image)) {
    made_progress(found->second, image.size(), now);
  }
  stream.next = number + 1;
  deliver(root, stream);
}

/// A question about a tree to which this robot does not belong in that way: the other one has to be told.
void Sink::disown(const MacAddress& from, const wire::GroupData& question) {
  wire::GroupReport report;
  report.root = question.root;
  report.root_boot = question.root_boot;
  report.stream = question.stream;
  report.packet = question.packet;
  outbox_.unicast(from, FrameType::kGroupReport, to_bytes(report));
}

/// This robot has not only got the packet but delivered it in its turn, and so have all behind it.
bool Sink::settled(const Place& place) {
  return place.transfer.packet->complete() && before(place.number, place.branch.streams[place.stream].next) &&
         place.transfer.to_children->done() && place.branch.tree.unrouted.empty();
}

void Sink::tell_complete(const Place& place, Time now) {
  const Tree& tree = place.branch.tree;
  if (place.root == self_.address) return;
  const bool done = settled(place);
  if (place.transfer.packet->complete()) place.transfer.room->complete(done, now);
  if (!tree.upstream || !done || place.transfer.flooded) return;
  const Told state{tree.epoch, tree.own_coverage(self_.address)};
  if (place.transfer.told == state) return;
  place.transfer.told = state;
  report(place, true, now);
}

void Sink::report_if_due(const Place& place, Time now) {
  if (place.transfer.report_due && *place.transfer.report_due <= now) report(place, false, now);
}

void Sink::report(const Place& place, bool reliably, Time now) {
  const Branch& branch = place.branch;
  const Tree& tree = branch.tree;
  Transfer& transfer = place.transfer;
  transfer.report_due.reset();
  if (!tree.upstream) return;
  const std::vector<Block>& blocks = transfer.packet->blocks();
  wire::GroupReport report;
  report.root = place.root;
  report.root_boot = tree.boot;
  report.stream = place.stream;
  report.packet = place.number;
  report.epoch = tree.epoch;
  report.round = transfer.round;
  report.complete = settled(place);
  report.coverage = tree.own_coverage(self_.address);
  report.measured_counter = branch.measured_counter;
  report.spacing_ns = static_cast<std::uint32_t>(std::min<Time::rep>(branch.spacing.count(), UINT32_MAX));
  while (report.first_block < blocks.size() && blocks[report.first_block].complete()) ++report.first_block;
  for (std::size_t block = report.first_block; block < blocks.size(); ++block) {
    if (report.missing.size() >= wire::kMostBlocksOfReport) break;
    report.missing.push_back(blocks[block].missing_for_report());
  }
  if (reliably) {
    outbox_.unicast(*tree.upstream, FrameType::kGroupReport, to_bytes(report));
  } else {
    outbox_.unicast_once(*tree.upstream, FrameType::kGroupReport, to_bytes(report), now);
  }
}

void Sink::expire(Branch& branch, Time now) {
  for (GroupStream& stream : branch.streams) {
    for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
      const bool idle = now - transfer->second.last_news >= kIdleTransfer;
      transfer = idle ? stream.transfers.erase(transfer) : std::next(transfer);
    }
  }
}

}  // namespace adhoc_communication::multicast
