#include "multicast/downlink.hpp"

#include <algorithm>

#include "round_robin.hpp"

namespace adhoc_communication::multicast {
namespace {

MacAddress previous_hop_of(const Branch& branch) { return branch.tree.upstream.value_or(MacAddress{}); }

}  // namespace

std::vector<MacAddress> Downlink::ask(const Place& place, std::uint32_t base, const std::set<MacAddress>& behind,
                                      Time now) {
  Distribution& to_children = *place.transfer.to_children;
  const std::vector<MacAddress> silent = to_children.poll(behind, now);
  if (silent.empty()) return {};
  std::vector<MacAddress> stuck = to_children.stuck(now);
  if (!stuck.empty()) return stuck;
  const std::uint16_t round = to_children.question_round();
  for (const MacAddress& child : silent) {
    wire::GroupData question = header(place, base);
    question.report = true;
    question.round = round;
    outbox_.unicast(child, wire::FrameType::kGroupData, to_bytes(question));
  }
  return {};
}

wire::GroupData Downlink::header(const Place& place, std::uint32_t base) {
  wire::GroupData data;
  data.root = place.root;
  data.root_boot = place.branch.tree.boot;
  data.stream = place.stream;
  data.hops = static_cast<std::uint8_t>(std::min<int>(place.transfer.hops + 1, wire::kFarthestHop));
  data.packet = place.number;
  data.base = base;
  data.total = place.transfer.packet->total();
  data.segment_size = place.transfer.packet->segment_size();
  return data;
}

bool Downlink::has_frame(std::uint8_t priority) const {
  const auto& all = branches_.all();
  return std::any_of(all.begin(), all.end(), [priority](const auto& item) { return item.second.has_frame(priority); });
}

void Downlink::add_waiting_hops(std::uint8_t priority, std::vector<MacAddress>& hops) const {
  for (const auto& [root, branch] : branches_.all()) {
    if (branch.has_frame(priority)) hops.push_back(previous_hop_of(branch));
  }
}

std::optional<Place> Downlink::next(std::uint8_t priority, const MacAddress& previous_hop) {
  Branch* branch = nullptr;
  visit_after(branches_.all(), last_root_served_, [&](auto& item) {
    if (previous_hop_of(item.second) != previous_hop || !item.second.has_frame(priority)) return false;
    last_root_served_ = item.first;
    branch = &item.second;
    return true;
  });
  if (branch == nullptr) return std::nullopt;
  auto& transfers = branch->streams[priority].transfers;
  const auto waiting = std::find_if(transfers.begin(), transfers.end(),
                                    [](const auto& item) { return item.second.to_children->has_frame(); });
  return Place{last_root_served_, *branch, priority, waiting->first, waiting->second};
}

GroupFrame Downlink::frame(const Place& place, std::uint32_t base, const std::optional<MacAddress>& follows, Time now) {
  const Distribution::Outgoing outgoing = place.transfer.to_children->next(carriage_, now);
  const auto only = outgoing.child ? outgoing.child : place.transfer.to_children->only_open_child();
  const MacAddress destination = only.value_or(wire::kEverybody);
  wire::GroupData data = header(place, base);
  data.report = outgoing.question;
  data.follows = follows == destination;
  data.round = outgoing.round;
  data.block = static_cast<std::uint16_t>(outgoing.block);
  data.symbol = static_cast<std::uint8_t>(outgoing.symbol);
  data.octets = place.transfer.packet->symbol(outgoing.block, outgoing.symbol);
  return {destination, to_bytes(data), outgoing.again};
}

}  // namespace adhoc_communication::multicast
