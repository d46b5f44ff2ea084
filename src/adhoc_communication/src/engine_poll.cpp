// Time: what is due now, and when something is due next.
#include <algorithm>

#include "engine_implementation.hpp"

namespace adhoc_communication {

namespace {

constexpr Time kTolerableLateness = std::chrono::milliseconds(20);
constexpr Time kLatestAcknowledgment = std::chrono::milliseconds(50);

EngineOptions validated(EngineOptions options) {
  validate(options);
  return options;
}

/// Octets of payload that fit a data frame behind header, `body` octets of fields, and the room for a tag.
std::size_t room(const EngineOptions& options, std::size_t body) {
  const int frame = std::min(options.max_frame_size, options.mtu + static_cast<int>(wire::kEthernetHeaderSize));
  return static_cast<std::size_t>(frame) - wire::kEthernetHeaderSize - wire::kHeaderSize - wire::kTagSize - body;
}

}  // namespace

Engine::Implementation::Implementation(EngineOptions options, MacAddress address, BootId boot_id, std::uint64_t seed,
                                       Time now)
    : options_(validated(std::move(options))),
      self_{options_.robot_name, address, boot_id, wire::boot_tag(boot_id)},
      journal_(options_.keep_records),
      guard_(self_, options_.keys, statistics_.frames_dropped),
      random_(seed),
      rhythm_(options_.beacon_interval, random_, now),
      neighbors_(options_.timings, options_.beacon_interval),
      directory_(runs_, self_.name),
      router_(self_, options_, neighbors_, runs_, directory_, *this, random_, journal_, now),
      segment_size_(room(options_, wire::kDataHeaderSize)),
      broadcast_segment_size_(room(options_, wire::kBroadcastDataHeaderSize)),
      air_(static_cast<std::size_t>(std::min(options_.max_frame_size, options_.mtu))),
      carriage_(air_, neighbors_),
      reassembly_(options_.max_packet_size),
      broadcast_receiver_(options_.max_packet_size, reassembly_),
      flood_(*this, random_),
      distributor_(self_, router_, *this, random_, air_, carriage_, reassembly_, options_.max_packet_size,
                   static_cast<std::uint16_t>(room(options_, wire::kGroupDataHeaderSize))),
      own_group_(static_cast<std::size_t>(options_.mtu) - wire::kHeaderSize - wire::kTagSize -
                 wire::kActivationHeaderSize),
      memberships_(directory_, options_.join_groups_automatically, own_group_.most()),
      now_(now),
      started_(now) {
  security::wipe(options_.keys);
}

std::vector<Frame> Engine::Implementation::poll(Time now) {
  now_ = now;
  touched_ = false;
  if (now - kTolerableLateness > expected_poll_) {
    for (const auto& [neighbor, link] : links_.busy()) link->sender.excuse_silence(now);
  }
  if (rhythm_.due() <= now) {
    maintain(now);
    send_beacon(now);
  }
  announce_changes(now);
  expire_sends(now);
  for (const auto& [neighbor, link] : links_.busy()) {
    link->sender.expire(now);
    if (link->sender.dead(now)) link_lost(neighbor, now);
  }
  serve_streams(now);
  acknowledge_streams(now);
  router_.poll(now);
  fail_unreachable(now);
  release_held(now);
  distributor_.poll(now);
  finish_group_members(now);
  take_group_packets(now);
  serve_floods(now);
  for (const auto& [neighbor, link] : links_.busy()) {
    if (!link->receiver || acknowledgment_due(*link->receiver) > now) continue;
    transmit(wire::FrameType::kHopAcknowledgment, 0, neighbor, 0, next_counter_++,
             to_bytes(link->receiver->acknowledge(now)), now);
  }
  pump(now);
  settle();
  expected_poll_ = next_deadline();
  return std::exchange(out_, {});
}

void Engine::Implementation::settle() {
  links_.settle([](const Link& link) { return link.idle(); });
  receivers_.settle([](const auto& receiver) { return receiver->next_deadline() == Time::max(); });
}

/// On a crowded channel one later acknowledgment for many frames is better than a queue of them in the radio.
Time Engine::Implementation::acknowledgment_due(const transport::HopReceiver& receiver) const {
  const Time due = receiver.due();
  if (due == Time::max()) return due;
  return std::max(due, std::min(air_.ready_at(), receiver.owed_since() + kLatestAcknowledgment));
}

Time Engine::Implementation::next_deadline() const {
  if (touched_) return now_;
  Time next = std::min({rhythm_.due(), router_.next_deadline(), flood_.next_deadline(), distributor_.next_deadline(),
                        terms_.next_deadline()});
  for (const auto& [neighbor, link] : links_.busy()) {
    next = std::min(next, link->sender.next_deadline());
    if (link->receiver) next = std::min(next, acknowledgment_due(*link->receiver));
  }
  for (const auto& [source, receiver] : receivers_.busy()) next = std::min(next, (*receiver)->next_deadline());
  for (const auto& [key, stream] : streams_.busy()) {
    if (stream->next_hop) next = std::min(next, stream->sender.next_deadline());
  }
  if (something_to_send()) next = std::min(next, air_.ready_at() > now_ ? air_.ready_at() : air_.idle_at());
  return next;
}

}  // namespace adhoc_communication
