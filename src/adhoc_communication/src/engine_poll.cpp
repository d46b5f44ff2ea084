// Time: what is due now, and when something is due next.
#include <algorithm>

#include "engine_implementation.hpp"

namespace adhoc_communication {

namespace {

constexpr Time kTolerableLateness = std::chrono::milliseconds(20);

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
      air_(static_cast<std::size_t>(std::min(options_.max_frame_size, options_.mtu))),
      transmitter_(self_, guard_, air_, rhythm_, statistics_),
      hops_(self_, options_, neighbors_, directory_, air_, transmitter_, journal_, statistics_),
      router_(self_, options_, neighbors_, runs_, directory_, hops_, random_, journal_, now),
      segment_size_(room(options_, wire::kDataHeaderSize)),
      broadcast_segment_size_(room(options_, wire::kBroadcastDataHeaderSize)),
      carriage_(air_, neighbors_),
      reassembly_(options_.max_packet_size),
      streams_(self_, options_, directory_, router_, hops_, random_, journal_, segment_size_),
      receivers_(self_, options_.max_packet_size, router_, hops_, reassembly_),
      forwarder_(self_, router_, hops_),
      broadcast_receiver_(options_.max_packet_size, reassembly_),
      flood_(hops_, random_),
      distributor_(self_, router_, hops_, random_, air_, carriage_, reassembly_, options_.max_packet_size,
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
  streams_.take_news();
  if (now - kTolerableLateness > expected_poll_) hops_.excuse_silence(now);
  if (rhythm_.due() <= now) {
    maintain(now);
    send_beacon(now);
  }
  announce_changes(now);
  expire_sends(now);
  for (const MacAddress& neighbor : hops_.expire(now)) link_lost(neighbor, now);
  serve_streams(now);
  receivers_.acknowledge(now);
  router_.poll(now);
  fail_unreachable(now);
  forwarder_.release(now);
  distributor_.poll(now);
  finish_group_members(now);
  take_group_packets(now);
  serve_floods(now);
  hops_.acknowledge(now);
  pump(now);
  settle();
  expected_poll_ = next_deadline();
  return transmitter_.take_frames();
}

void Engine::Implementation::settle() {
  hops_.settle();
  receivers_.settle();
}

Time Engine::Implementation::next_deadline() const {
  if (touched_ || streams_.has_news()) return now_;
  Time next =
      std::min({rhythm_.due(), router_.next_deadline(), flood_.next_deadline(), distributor_.next_deadline(),
                terms_.next_deadline(), hops_.next_deadline(), receivers_.next_deadline(), streams_.next_deadline()});
  if (something_to_send()) next = std::min(next, air_.ready_at() > now_ ? air_.ready_at() : air_.idle_at());
  return next;
}

}  // namespace adhoc_communication
