#include "multicast/distributor.hpp"

#include <algorithm>

namespace adhoc_communication::multicast {
namespace {

/// Where in the parity symbols to begin, so that neighbours that both send differ.
std::uint8_t first_parity(const Identity& self) { return static_cast<std::uint8_t>(digest(self.address)); }

/// That fit where a frame of group data does.
std::size_t most_receipts(std::size_t segment_size) {
  return std::min((segment_size + wire::kGroupDataHeaderSize - 1) / wire::kGroupReceiptSize, wire::kMostReceipts);
}

/// What this robot has of the packets behind the one that it waits for.
std::uint32_t beyond_next(const GroupStream& stream) {
  std::uint32_t beyond = 0;
  for (const auto& [number, transfer] : stream.transfers) {
    const std::uint32_t ahead = number - stream.next - 1;
    if (ahead < 32 && transfer.packet->complete()) beyond |= std::uint32_t{1} << ahead;
  }
  return beyond;
}

}  // namespace

Distributor::Distributor(const Identity& self, routing::Router& router, Outbox& outbox, Random& random,
                         air::AirClock& air, const Carriage& carriage, const routing::Neighbors& neighbors,
                         transport::Reassembly& reassembly, std::size_t largest_packet, std::uint16_t segment_size)
    : self_(self),
      air_(air),
      carriage_(carriage),
      segment_size_(segment_size),
      branches_(self),
      trees_(self, neighbors, router, outbox, branches_),
      source_(segment_size, first_parity(self)),
      sink_(self, router, outbox, random, reassembly, largest_packet, first_parity(self)),
      downlink_(outbox, branches_, carriage),
      flooding_(self, neighbors, random),
      receipts_(neighbors, router, flooding_, outbox, random, most_receipts(segment_size)) {}

/// What changes of trees mean for the packets on them.
void Distributor::settle(Time now) {
  for (const LeftOver& left_over : trees_.take_left_over()) source_.left_over(*branches_.own(), left_over, now);
  for (const ChangedBranch& changed : trees_.take_changed()) {
    branches_.all().at(changed.root).children_changed(changed.anew, now);
  }
}

bool Distributor::builds_anew() const {
  const auto own = branches_.all().find(self_.address);
  return own == branches_.all().end() || source_.wants_fresh_tree(own->second);
}

bool Distributor::floods(std::size_t octets, Priority priority, std::size_t members, std::size_t far_members,
                         std::size_t robots) const {
  if (octets > segment_size_ || members < kFewestFlooded || !carriage_.flood_pays(robots, far_members)) return false;
  const auto own = branches_.all().find(self_.address);
  return own == branches_.all().end() || source_.may_flood(own->second, priority);
}

std::uint32_t Distributor::flood(SendId id, Priority priority, transport::Image image,
                                 const std::set<MacAddress>& members, Time now) {
  Branch& own = branches_.of(self_.address, self_.boot, now);
  own.tree.last_used = now;
  wire::GroupData data = source_.start_flooded(own, id, priority, std::move(image), members, now);
  const std::uint32_t number = data.packet;
  data.root = self_.address;
  flooding_.originate(std::move(data), now);
  return number;
}

std::uint32_t Distributor::start(SendId id, Priority priority, transport::Image image,
                                 const std::set<MacAddress>& members, Time now) {
  Branch& own = branches_.of(self_.address, self_.boot, now);
  own.tree.last_used = now;
  if (source_.wants_fresh_tree(own)) {
    trees_.build_anew(own.tree, source_.fresh_tree(own, members, now), now);
  } else if (!members.empty()) {
    trees_.add_members(own.tree, members, now);
  }
  settle(now);
  return source_.start(own, id, priority, std::move(image), members, now);
}

std::optional<std::uint32_t> Distributor::replace(SendId former, SendId id, const transport::Image& image,
                                                  const std::set<MacAddress>& members, Time now) {
  Branch* own = branches_.own();
  return own == nullptr ? std::nullopt : source_.replace(*own, former, id, image, members, now);
}

std::set<MacAddress> Distributor::drop(SendId id) {
  Branch* own = branches_.own();
  return own == nullptr ? std::set<MacAddress>{} : source_.drop(*own, id);
}

void Distributor::copy_arrived(const MacAddress& member, std::uint8_t stream, std::uint32_t number, Time now) {
  if (Branch* own = branches_.own()) source_.copy_arrived(*own, member, {stream, number}, now);
}

void Distributor::drop_member(const MacAddress& member, const std::string& reason, Time now) {
  Branch* own = branches_.own();
  if (own == nullptr) return;
  source_.drop_member(*own, member, reason);
  trees_.prune(own->tree, member);
  settle(now);
}

void Distributor::on_activation(const Run& from, const wire::GroupActivation& activation, bool takes_part, Time now) {
  trees_.on_activation(from, activation, takes_part, now);
  settle(now);
}

void Distributor::on_refusal(const MacAddress& from, const wire::GroupRefusal& refusal, Time now) {
  trees_.on_refusal(from, refusal, now);
  settle(now);
}

bool Distributor::has_place(const MacAddress& root, wire::BootTag boot) const {
  const auto found = branches_.all().find(root);
  return found != branches_.all().end() && found->second.tree.boot == boot && found->second.tree.upstream;
}

bool Distributor::on_data(const MacAddress& from, std::uint64_t counter, const wire::GroupData& data, bool member,
                          Time now) {
  if (data.flooded) return on_flooded(from, data, member, now);
  if (branches_.is_root(data.root)) return false;
  const bool expected = member && !has_place(data.root, data.root_boot);
  const bool question = data.octets.empty();
  Branch* branch = branches_.find(data.root, data.root_boot);
  if (branch != nullptr && !branch->tree.upstream && !expected) branch = nullptr;
  if (branch == nullptr && expected && !question) branch = &branches_.of(data.root, data.root_boot, now);
  const std::uint32_t next = branch == nullptr ? 0 : branch->streams[data.stream].next;
  const bool of_use = sink_.on_data(from, counter, data, branch, now);
  if (of_use && branch->streams[data.stream].next - next > 1) owe_receipt(data.root, *branch, data.stream, now);
  return of_use;
}

bool Distributor::on_flooded(const MacAddress& from, const wire::GroupData& data, bool member, Time now) {
  flooding_.take(from, data, now);
  if (branches_.is_root(data.root) || !member) return false;
  Branch& branch = branches_.of(data.root, data.root_boot, now);
  if (!sink_.on_flooded(data, branch, now)) return false;
  owe_receipt(data.root, branch, data.stream, now);
  return true;
}

/// Where packets were flooded, their root is told what has come of them, or was waiting for others.
void Distributor::owe_receipt(const MacAddress& root, const Branch& branch, std::uint8_t stream_number, Time now) {
  const GroupStream& stream = branch.streams[stream_number];
  if (stream.flood_hops == 0) return;
  receipts_.owe({root, branch.tree.boot, stream_number, self_.address, stream.next, beyond_next(stream)},
                stream.flood_hops, now);
}

void Distributor::on_receipts(const wire::GroupReceipts& receipts, Time now) {
  Branch* own = branches_.own();
  for (const wire::GroupReceipt& receipt : receipts.receipts) {
    if (!branches_.is_root(receipt.root)) {
      receipts_.pass_on(receipt, now);
    } else if (own != nullptr && receipt.root_boot == self_.boot) {
      source_.receipt(*own, receipt, now);
    }
  }
}

void Distributor::on_report(const MacAddress& from, const wire::GroupReport& report, Time now) {
  Branch* branch = branches_.find(report.root, report.root_boot);
  if (branch == nullptr || branch->tree.children.count(from) == 0) return;
  if (report.measured_counter != 0) air_.acknowledged_late(report.measured_counter, Time(report.spacing_ns), now);
  auto& transfers = branch->streams[report.stream].transfers;
  const auto found = transfers.find(report.packet);
  if (found == transfers.end()) return;
  Tree& tree = branch->tree;
  Transfer& transfer = found->second;
  const bool covers_all = report.epoch == tree.epoch && report.coverage == tree.coverage(from);
  if (!covers_all) trees_.activate_again(report.root, tree, from, now);
  if (!transfer.to_children->reported(from, report, covers_all, now)) return;
  if (branches_.is_root(report.root)) return source_.reached(transfer, tree.children[from]);
  sink_.tell_complete({report.root, *branch, report.stream, report.packet, transfer}, now);
}

void Distributor::evicted(const transport::Reassembly::Key& key) {
  if (Branch* branch = branches_.find(key.source, key.boot)) sink_.evicted(*branch, key);
}

void Distributor::take_copy(const MacAddress& root, wire::BootTag boot, std::uint8_t stream_number,
                            std::uint32_t number, const Bytes& image, Time now) {
  Branch& branch = branches_.of(root, boot, now);
  GroupStream& stream = branch.streams[stream_number];
  const bool is_news = stream.started && !before(number, stream.next);
  sink_.take_copy(root, branch, stream_number, number, image, now);
  if (stream.next - number > 1) owe_receipt(root, branch, stream_number, now);
  if (is_news) pass_on_copy(root, branch, stream_number, number, image, now);
}

/// Where a link that carries floods has lost the packet, all beyond it lack it.
void Distributor::pass_on_copy(const MacAddress& root, const Branch& branch, std::uint8_t stream_number,
                               std::uint32_t number, const Bytes& image, Time now) {
  const GroupStream& stream = branch.streams[stream_number];
  if (stream.flood_hops == 0 || !stream.base || image.size() > segment_size_) return;
  wire::GroupData data;
  data.root = root;
  data.root_boot = branch.tree.boot;
  data.stream = stream_number;
  data.flooded = true;
  data.hops = static_cast<std::uint8_t>(std::min<int>(stream.flood_hops + 1, wire::kFarthestHop));
  data.packet = number;
  data.base = *stream.base;
  data.total = static_cast<std::uint32_t>(image.size());
  data.segment_size = segment_size_;
  data.octets = image;
  flooding_.take_copy(std::move(data), now);
}

void Distributor::link_lost(const MacAddress& neighbor, Time now) {
  trees_.link_lost(neighbor);
  settle(now);
  receipts_.link_lost(neighbor, now);
}

void Distributor::unreachable(const MacAddress& member, const std::string& reason, bool nearby, Time now) {
  trees_.unreachable(member, reason, nearby);
  settle(now);
}

void Distributor::poll(Time now) {
  Branch* own = branches_.own();
  if (own != nullptr) {
    if (const auto members = source_.wants_tree_anew(*own, now)) trees_.build_anew(own->tree, *members, now);
    source_.serve_late(*own, now);
    settle(now);
  }
  trees_.attach_routed(now);
  settle(now);
  for (auto& [root, branch] : branches_.all()) {
    if (!std::exchange(branch.busy, false)) continue;
    serve(root, branch, now);
    const bool idle = branch.next_deadline() == Time::max() && !branch.sends();
    branch.busy = branch.busy || !idle;
  }
  if (own != nullptr) Source::remove_finished(*own);
  flooding_.poll(now);
  receipts_.poll(now);
}

void Distributor::serve(const MacAddress& root, Branch& branch, Time now) {
  for (std::uint8_t stream = 0; stream < transport::kPriorities; ++stream) {
    std::set<MacAddress> behind;
    for (auto& [number, transfer] : branch.streams[stream].transfers) {
      const Place place{root, branch, stream, number, transfer};
      sink_.tell_complete(place, now);
      sink_.report_if_due(place, now);
      trees_.give_up(root, branch.tree, downlink_.ask(place, base_of(place), behind, now));
      settle(now);
      transfer.to_children->add_open(behind);
    }
  }
}

/// The packets before are finished at the root, as far as this robot has been told: by frames heard before it had its
/// place, too, or whoever is behind it would begin with this packet.
std::uint32_t Distributor::base_of(const Place& place) const {
  if (branches_.is_root(place.root)) return source_.oldest_open(place.branch, place.stream);
  const GroupStream& stream = place.branch.streams[place.stream];
  return stream.base.value_or(stream.early.value_or(place.number));
}

std::optional<GroupFrame> Distributor::next_frame(std::uint8_t priority, const MacAddress& previous_hop,
                                                  const std::optional<MacAddress>& follows, Time now) {
  if (auto flooded = flooding_.next(priority, previous_hop, now)) return flooded;
  const std::optional<Place> place = downlink_.next(priority, previous_hop);
  if (!place) return std::nullopt;
  Sink::passed_on(place->transfer, now);
  return downlink_.frame(*place, base_of(*place), follows, now);
}

Time Distributor::next_deadline() const {
  Time next = std::min({source_.next_late(), flooding_.next_deadline(), receipts_.next_deadline()});
  for (const auto& [root, branch] : branches_.all()) {
    if (branch.busy) next = std::min(next, branch.next_deadline());
  }
  return next;
}

void Distributor::expire(Time now) {
  for (auto& [root, branch] : branches_.all()) {
    if (!branches_.is_root(root)) Sink::expire(branch, now);
  }
  branches_.expire(now);
  receipts_.expire(now);
}

}  // namespace adhoc_communication::multicast
