// Packets on the trees: started, taken, passed on, reported, delivered.
#include "multicast/distributor.hpp"

#include <algorithm>

#include "round_robin.hpp"

namespace adhoc_communication::multicast {
namespace {

bool before(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b) < 0; }

}  // namespace

using wire::FrameType;

Distributor::Distributor(const Identity& self, routing::Router& router, Outbox& outbox, Random& random,
                         transport::AirClock& air, transport::Reassembly& reassembly, std::size_t largest_packet,
                         std::uint16_t segment_size)
    : self_(self),
      router_(router),
      outbox_(outbox),
      random_(random),
      air_(air),
      reassembly_(reassembly),
      largest_packet_(largest_packet),
      segment_size_(segment_size),
      first_parity_(static_cast<std::uint8_t>(digest(self.address))) {}

Distributor::~Distributor() = default;

std::uint32_t Distributor::start(SendId id, Priority priority, transport::Image image,
                                 const std::set<MacAddress>& members, Time now) {
  Tree& tree = tree_of(self_.address, self_.boot, now);
  tree.last_used = now;
  renew_stale(tree);
  GroupStream& stream = branches_[self_.address].streams[static_cast<std::size_t>(priority)];
  const std::uint32_t number = stream.next++;
  if (members.empty()) return number;
  std::set<MacAddress> newcomers;
  for (const MacAddress& member : members) {
    if (tree.holds(member)) continue;
    newcomers.insert(member);
    tree.refused.erase(member);
  }
  attach(self_.address, tree, newcomers, now);
  std::set<MacAddress> changed;
  for (const auto& [child, behind] : tree.children) {
    const bool concerns = std::any_of(newcomers.begin(), newcomers.end(),
                                      [&, &behind = behind](const auto& member) { return behind.count(member) != 0; });
    if (concerns) changed.insert(child);
  }
  activate(self_.address, tree, changed);
  children_changed(self_.address, false, now);

  Transfer& transfer = stream.transfers[number];
  begin(transfer, id, std::move(image), tree, now);
  transfer.open = members;
  return number;
}

void Distributor::begin(Transfer& transfer, SendId id, transport::Image image, const Tree& tree, Time now) {
  transfer.to_children.reset();  // before the packet that it refers to
  transfer.packet = std::make_unique<GroupPacket>(*image, segment_size_);
  transfer.to_children =
      std::make_unique<Distribution>(*transfer.packet, branches_[self_.address].round_trip, first_parity_);
  transfer.to_children->set_children(tree.coverages(), true, now);
  transfer.hops = 0;
  transfer.id = id;
  transfer.image = std::move(image);
  transfer.last_news = now;
}

std::optional<std::uint32_t> Distributor::replace(SendId former, SendId id, const transport::Image& image, Time now) {
  const auto own = trees_.find(self_.address);
  if (own == trees_.end()) return std::nullopt;
  for (GroupStream& stream : branches_[self_.address].streams) {
    for (auto& [number, transfer] : stream.transfers) {
      if (transfer.id != former) continue;
      if (transfer.to_children->begun() || stream.copies.count(number) != 0) return std::nullopt;
      begin(transfer, id, image, own->second, now);
      branches_[self_.address].busy = true;
      return number;
    }
  }
  return std::nullopt;
}

std::set<MacAddress> Distributor::drop(SendId id) {
  const auto own = branches_.find(self_.address);
  if (own == branches_.end()) return {};
  for (GroupStream& stream : own->second.streams) {
    for (auto& [number, transfer] : stream.transfers) {
      if (transfer.id == id) return std::exchange(transfer.open, {});
    }
  }
  return {};
}

void Distributor::finish_member(Transfer& transfer, const MemberEnd& end) {
  if (transfer.open.erase(end.member) != 0) ends_.push_back(end);
}

void Distributor::drop_member(const MacAddress& member, const std::string& reason, Time now) {
  const auto own = trees_.find(self_.address);
  if (own == trees_.end()) return;
  Branch& branch = branches_[self_.address];
  for (GroupStream& stream : branch.streams) {
    for (auto& [number, transfer] : stream.transfers) {
      finish_member(transfer, {transfer.id, member, false, false, reason});
    }
  }
  branch.refusals.erase(member);
  const auto child = own->second.remove(member);
  if (!child) return;
  activate(self_.address, own->second, {*child});
  if (own->second.children[*child].empty()) own->second.children.erase(*child);
  children_changed(self_.address, false, now);
}

/// Packets whose members all have come to an end.
void Distributor::remove_finished() {
  const auto own = branches_.find(self_.address);
  if (own == branches_.end()) return;
  for (GroupStream& stream : own->second.streams) {
    for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
      transfer = transfer->second.open.empty() ? stream.transfers.erase(transfer) : std::next(transfer);
    }
  }
}

void Distributor::erase_transfer(GroupStream& stream, GroupStream::Transfers::iterator transfer) {
  if (transfer->second.room) reassembly_.release(*transfer->second.room);
  stream.transfers.erase(transfer);
}

void Distributor::evicted(const transport::Reassembly::Key& key) {
  const Tree* tree = find_tree(key.source, key.boot);
  if (tree == nullptr) return;
  GroupStream& stream = branches_.at(key.source).streams[key.carrier - transport::Reassembly::kGroup];
  const auto found = stream.transfers.find(key.packet);
  if (found != stream.transfers.end()) erase_transfer(stream, found);
}

void Distributor::on_data(const MacAddress& from, std::uint64_t counter, const wire::GroupData& data, Time now) {
  if (is_root(data.root)) return;
  Tree* tree = find_tree(data.root, data.root_boot);
  const bool question = data.octets.empty();
  if (tree == nullptr || !tree->upstream || (question && tree->upstream != from)) {
    if (question) disown(from, data);
    return;
  }
  tree->last_used = now;
  Branch& branch = branches_[data.root];
  const bool from_upstream = tree->upstream == from;
  if (from_upstream) {
    if (data.follows && counter == branch.last_counter + 1) {
      branch.measured_counter = counter;
      branch.spacing = now - branch.last_arrival;
    }
    branch.last_counter = counter;
    branch.last_arrival = now;
  }
  if (from_upstream) pass_over(data.root, branch.streams[data.stream], data.base);
  Transfer* transfer = transfer_for(data.root, *tree, data, now);
  if (transfer == nullptr) return;
  transfer->last_news = now;
  if (!question && transfer->packet->take(data.block, data.symbol, data.octets)) {
    made_progress(*transfer, data.octets.size(), now);
    deliver(data.root, branch.streams[data.stream]);
  }
  if (!from_upstream || !data.report) return;
  transfer->round = std::max(transfer->round, data.round);
  if (question) return report(data.root, *tree, data.stream, data.packet, *transfer, true);
  transfer->report_due = now + random_.delay(kReportJitter);
}

void Distributor::made_progress(const Transfer& transfer, std::size_t octets, Time now) {
  if (!transfer.room) return;
  reassembly_.progress(*transfer.room, octets, now);
  if (transfer.packet->complete()) reassembly_.keep(*transfer.room);
}

Transfer* Distributor::transfer_for(const MacAddress& root, Tree& tree, const wire::GroupData& data, Time now) {
  Branch& branch = branches_[root];
  GroupStream& stream = branch.streams[data.stream];
  if (!stream.base) stream.base = data.base;
  if (!std::exchange(stream.started, true)) stream.next = data.base;
  const auto found = stream.transfers.find(data.packet);
  if (found != stream.transfers.end()) {
    const GroupPacket& packet = *found->second.packet;
    const bool same = packet.total() == data.total && packet.segment_size() == data.segment_size;
    return same ? &found->second : nullptr;
  }
  if (data.total > largest_packet_ || stream.transfers.size() >= kMostTransfers) return nullptr;
  if (data.packet - *stream.base >= kPacketsAhead) return nullptr;
  const auto carrier = static_cast<std::uint8_t>(transport::Reassembly::kGroup + data.stream);
  const transport::Reassembly::Key room{root, tree.boot, carrier, data.packet};
  if (!reassembly_.admit(room, data.total, data.packet == stream.next, now)) {
    tell_no_room(tree, data, stream, now);
    return nullptr;
  }
  Transfer& transfer = stream.transfers[data.packet];
  transfer.room = room;
  transfer.packet = std::make_unique<GroupPacket>(data.total, data.segment_size);
  transfer.to_children = std::make_unique<Distribution>(*transfer.packet, branch.round_trip, first_parity_);
  transfer.to_children->set_children(tree.coverages(), true, now);
  transfer.hops = data.hops;
  for (const auto& [child, members] : tree.children) {
    for (const MacAddress& member : members) router_.used(root, member, *tree.upstream, now);
  }
  return &transfer;
}

/// Until there is room, the upstream neighbour keeps its frames and asks now and then.
void Distributor::tell_no_room(const Tree& tree, const wire::GroupData& data, GroupStream& stream, Time now) {
  const bool question = data.octets.empty();
  if (!question && now - stream.told_no_room < kNoRoomInterval) return;
  stream.told_no_room = now;
  wire::GroupReport report;
  report.root = data.root;
  report.root_boot = data.root_boot;
  report.stream = data.stream;
  report.packet = data.packet;
  report.epoch = tree.epoch;
  report.round = data.round;
  report.coverage = tree.own_coverage(self_.address);
  report.first_block = wire::kNoRoom;
  outbox_.unicast(*tree.upstream, FrameType::kGroupReport, to_bytes(report));
}

/// The root has finished the packets before `base`: with what did not get here by then it has given up.
void Distributor::pass_over(const MacAddress& root, GroupStream& stream, std::uint32_t base) {
  if (!stream.started || (stream.base && !before(*stream.base, base))) return;
  stream.base = base;
  skip_to(root, stream, base);
  for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
    const auto candidate = transfer++;
    if (before(candidate->first, base)) erase_transfer(stream, candidate);
  }
  deliver(root, stream);
}

/// What is missing before `number` will not come any more.
void Distributor::skip_to(const MacAddress& root, GroupStream& stream, std::uint32_t number) {
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

void Distributor::deliver(const MacAddress& root, GroupStream& stream) {
  for (;;) {
    const auto found = stream.transfers.find(stream.next);
    if (found == stream.transfers.end() || !found->second.packet->complete()) return;
    arrived_.push_back({root, found->second.packet->image(), found->second.hops});
    ++stream.next;
  }
}

void Distributor::take_copy(const MacAddress& root, wire::BootTag boot, std::uint8_t stream_number,
                            std::uint32_t number, const Bytes& image, Time now) {
  Tree& tree = tree_of(root, boot, now);
  tree.last_used = now;
  GroupStream& stream = branches_[root].streams[stream_number];
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

void Distributor::on_report(const MacAddress& from, const wire::GroupReport& report, Time now) {
  Tree* tree = find_tree(report.root, report.root_boot);
  if (tree == nullptr) return;
  if (tree->children.count(from) == 0) return;
  if (report.measured_counter != 0) air_.acknowledged_late(report.measured_counter, Time(report.spacing_ns), now);
  GroupStream& stream = branches_[report.root].streams[report.stream];
  const auto found = stream.transfers.find(report.packet);
  if (found == stream.transfers.end()) return;
  Transfer& transfer = found->second;
  const bool covers_all = report.epoch == tree->epoch && report.coverage == tree->coverage(from);
  if (!covers_all) activate_again(report.root, *tree, from, now);
  if (!transfer.to_children->reported(from, report, covers_all, now)) return;
  if (!is_root(report.root)) return tell_complete(report.root, *tree, report.stream, report.packet, transfer);
  for (const MacAddress& member : tree->children[from]) {
    branches_[self_.address].refusals.erase(member);
    finish_member(transfer, {transfer.id, member, true, false, {}});
  }
}

/// A question about a tree to which this robot does not belong in that way: the other one has to be told.
void Distributor::disown(const MacAddress& from, const wire::GroupData& question) {
  wire::GroupReport report;
  report.root = question.root;
  report.root_boot = question.root_boot;
  report.stream = question.stream;
  report.packet = question.packet;
  outbox_.unicast(from, FrameType::kGroupReport, to_bytes(report));
}

/// This robot has not only got the packet but delivered it in its turn, and so have all behind it.
bool Distributor::settled(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
                          const Transfer& transfer) const {
  return transfer.packet->complete() && before(number, branches_.at(root).streams[stream].next) &&
         transfer.to_children->done() && tree.unrouted.empty();
}

/// Once this robot and all behind it have the packet, upstream hears of it reliably.
void Distributor::tell_complete(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
                                Transfer& transfer) {
  if (is_root(root) || !tree.upstream) return;
  if (!settled(root, tree, stream, number, transfer)) return;
  const std::pair state(tree.epoch, tree.own_coverage(self_.address));
  if (transfer.told == state) return;
  transfer.told = state;
  transfer.report_due.reset();
  report(root, tree, stream, number, transfer, true);
}

void Distributor::report(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
                         Transfer& transfer, bool reliably) {
  transfer.report_due.reset();
  if (!tree.upstream) return;
  const Branch& branch = branches_.at(root);
  const std::vector<Block>& blocks = transfer.packet->blocks();
  wire::GroupReport report;
  report.root = root;
  report.root_boot = tree.boot;
  report.stream = stream;
  report.packet = number;
  report.epoch = tree.epoch;
  report.round = transfer.round;
  report.complete = settled(root, tree, stream, number, transfer);
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
    outbox_.unicast_once(*tree.upstream, FrameType::kGroupReport, to_bytes(report));
  }
}

void Distributor::poll(Time now) {
  build_anew(now);
  attach_routed(now);
  for (auto& [root, tree] : trees_) {
    Branch& branch = branches_.at(root);
    if (!std::exchange(branch.busy, false)) continue;
    for (std::uint8_t stream = 0; stream < transport::kPriorities; ++stream) {
      for (auto& [number, transfer] : branch.streams[stream].transfers) {
        serve(root, tree, stream, number, transfer, now);
      }
    }
    branch.busy = branch.busy || !idle(branch);
  }
  remove_finished();
}

/// Until something comes for it, nothing is sent and nothing is due.
bool Distributor::idle(const Branch& branch) {
  return std::none_of(branch.streams.begin(), branch.streams.end(), [](const GroupStream& stream) {
    return std::any_of(stream.transfers.begin(), stream.transfers.end(), [](const auto& item) {
      const Transfer& transfer = item.second;
      return transfer.report_due || transfer.to_children->has_frame() ||
             transfer.to_children->next_deadline() != Time::max();
    });
  });
}

void Distributor::serve(const MacAddress& root, Tree& tree, std::uint8_t stream, std::uint32_t number,
                        Transfer& transfer, Time now) {
  tell_complete(root, tree, stream, number, transfer);
  if (transfer.report_due && *transfer.report_due <= now) report(root, tree, stream, number, transfer, false);
  const std::vector<MacAddress> silent = transfer.to_children->poll(now);
  if (silent.empty()) return;
  const std::vector<MacAddress> stuck = transfer.to_children->stuck(now);
  if (!stuck.empty()) return give_up(root, tree, stuck, now);
  const std::uint16_t round = transfer.to_children->question_round();
  for (const MacAddress& child : silent) {
    wire::GroupData question = header(root, tree, stream, number, transfer);
    question.report = true;
    question.round = round;
    outbox_.unicast(child, FrameType::kGroupData, to_bytes(question));
  }
}

wire::GroupData Distributor::header(const MacAddress& root, const Tree& tree, std::uint8_t stream, std::uint32_t number,
                                    const Transfer& transfer) const {
  wire::GroupData data;
  data.root = root;
  data.root_boot = tree.boot;
  data.stream = stream;
  data.hops = static_cast<std::uint8_t>(std::min<int>(transfer.hops + 1, wire::kFarthestHop));
  data.packet = number;
  const GroupStream& packets = branches_.at(root).streams[stream];
  data.base = is_root(root) ? oldest_open(packets) : packets.base.value_or(number);
  data.total = transfer.packet->total();
  data.segment_size = transfer.packet->segment_size();
  return data;
}

/// At the root: the first packet that the tree or a copy still has to bring to somebody.
std::uint32_t Distributor::oldest_open(const GroupStream& stream) {
  std::uint32_t oldest = stream.next;
  for (const auto& [number, transfer] : stream.transfers) oldest = before(number, oldest) ? number : oldest;
  for (const std::uint32_t number : stream.copies) oldest = before(number, oldest) ? number : oldest;
  return oldest;
}

void Distributor::copy_started(std::uint8_t stream, std::uint32_t number) {
  branches_[self_.address].streams[stream].copies.insert(number);
}

void Distributor::copy_finished(std::uint8_t stream, std::uint32_t number) {
  auto& copies = branches_[self_.address].streams[stream].copies;
  if (const auto found = copies.find(number); found != copies.end()) copies.erase(found);
}

bool Distributor::has_frame(std::uint8_t priority) const {
  return std::any_of(branches_.begin(), branches_.end(),
                     [priority](const auto& item) { return has_frame(item.second, priority); });
}

bool Distributor::has_frame(const Branch& branch, std::uint8_t priority) {
  if (!branch.busy) return false;
  const auto& transfers = branch.streams[priority].transfers;
  return std::any_of(transfers.begin(), transfers.end(),
                     [](const auto& transfer) { return transfer.second.to_children->has_frame(); });
}

MacAddress Distributor::previous_hop(const MacAddress& root) const {
  return trees_.at(root).upstream.value_or(MacAddress{});
}

void Distributor::add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const {
  for (const auto& [root, branch] : branches_) {
    if (has_frame(branch, priority)) hops.push_back(previous_hop(root));
  }
}

std::optional<GroupFrame> Distributor::next_frame(std::uint8_t priority, const MacAddress& from, bool follows,
                                                  Time now) {
  std::optional<GroupFrame> frame;
  visit_after(branches_, last_root_served_, [&](auto& item) {
    if (!item.second.busy || previous_hop(item.first) != from) return false;
    frame = next_frame_of(item.first, item.second, priority, follows, now);
    return frame.has_value();
  });
  return frame;
}

std::optional<GroupFrame> Distributor::next_frame_of(const MacAddress& root, Branch& branch, std::uint8_t priority,
                                                     bool follows, Time now) {
  for (auto& [number, transfer] : branch.streams[priority].transfers) {
    if (!transfer.to_children->has_frame()) continue;
    last_root_served_ = root;
    const Distribution::Outgoing outgoing = transfer.to_children->next(now);
    wire::GroupData data = header(root, trees_.at(root), priority, number, transfer);
    data.report = outgoing.question;
    data.follows = follows;
    data.round = outgoing.round;
    data.block = static_cast<std::uint16_t>(outgoing.block);
    data.symbol = static_cast<std::uint8_t>(outgoing.symbol);
    data.octets = transfer.packet->symbol(outgoing.block, outgoing.symbol);
    const auto only = transfer.to_children->only_open_child();
    return GroupFrame{only.value_or(wire::kEverybody), to_bytes(data)};
  }
  return std::nullopt;
}

Time Distributor::next_deadline() const {
  Time next = Time::max();
  for (const auto& [root, branch] : branches_) {
    if (!branch.busy) continue;
    for (const GroupStream& stream : branch.streams) {
      for (const auto& [number, transfer] : stream.transfers) {
        next = std::min(next, transfer.to_children->next_deadline());
        if (transfer.report_due) next = std::min(next, *transfer.report_due);
      }
    }
  }
  return next;
}

void Distributor::expire(Time now) {
  std::vector<MacAddress> idle;
  for (auto& [root, tree] : trees_) {
    if (now - tree.last_used >= kIdleTree) idle.push_back(root);
    if (is_root(root)) continue;
    for (GroupStream& stream : branches_[root].streams) {
      for (auto transfer = stream.transfers.begin(); transfer != stream.transfers.end();) {
        const auto candidate = transfer++;
        if (now - candidate->second.last_news >= kIdleTransfer) erase_transfer(stream, candidate);
      }
    }
  }
  for (const MacAddress& root : idle) {
    // The numbers of the own packets go on for ever.
    if (!is_root(root)) forget_tree(root);
  }
}

}  // namespace adhoc_communication::multicast
