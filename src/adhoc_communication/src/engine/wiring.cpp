// Who knows whom.
#include <algorithm>

#include "engine/implementation.hpp"

namespace adhoc_communication {
namespace {

EngineOptions validated(EngineOptions options) {
  validate(options);
  return options;
}

/// Octets of payload that fit a data frame behind header, `body` octets of fields, and the room for a tag.
std::uint16_t room(const EngineOptions& options, std::size_t body) {
  const int frame = std::min(options.max_frame_size, options.mtu + static_cast<int>(wire::kEthernetHeaderSize));
  const std::size_t others = wire::kEthernetHeaderSize + wire::kHeaderSize + wire::kTagSize + body;
  return static_cast<std::uint16_t>(static_cast<std::size_t>(frame) - others);
}

/// Octets for the members of the own group in one activation.
std::size_t room_for_members(const EngineOptions& options) {
  return static_cast<std::size_t>(options.mtu) - wire::kHeaderSize - wire::kTagSize - wire::kActivationHeaderSize;
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
      runs_(options_.num_link_retrans > 0),
      admission_(self_, guard_, runs_, neighbors_, rhythm_, statistics_.frames_dropped),
      directory_(runs_, self_.name),
      air_(static_cast<std::size_t>(std::min(options_.max_frame_size, options_.mtu))),
      transmitter_(self_, guard_, air_, rhythm_, statistics_),
      hops_(self_, options_, neighbors_, directory_, air_, transmitter_, journal_, statistics_),
      router_(self_, options_, neighbors_, runs_, directory_, hops_, random_, journal_, now),
      presence_(self_, options_, neighbors_, runs_, directory_, router_, rhythm_, hops_, now),
      reassembly_(options_.max_packet_size),
      streams_(self_, options_, directory_, router_, hops_, random_, journal_, room(options_, wire::kDataHeaderSize)),
      receivers_(self_, options_.max_packet_size, router_, hops_, reassembly_),
      forwarder_(self_, router_, hops_),
      broadcast_receiver_(options_.max_packet_size, reassembly_),
      flood_(hops_, random_),
      carriage_(air_, neighbors_),
      distributor_(self_, router_, hops_, random_, air_, carriage_, neighbors_, reassembly_, options_.max_packet_size,
                   room(options_, wire::kGroupDataHeaderSize)),
      groups_(self_, room_for_members(options_), options_.join_groups_automatically, directory_, router_, distributor_),
      schedule_(air_, transmitter_, hops_, streams_, broadcasts_, distributor_, statistics_),
      links_(forwarder_, distributor_),
      outgoing_(self_, options_.max_packet_size, room(options_, wire::kBroadcastDataHeaderSize), room(options_, 0),
                {streams_, broadcasts_, flood_, groups_}, events_, statistics_),
      incoming_(options_.max_packet_size, directory_, router_,
                {receivers_, broadcast_receiver_, distributor_, groups_, reassembly_}, outgoing_, events_, statistics_),
      reception_(
          options_.loss_ratio,
          {self_,     guard_,    random_,    rhythm_,    admission_, neighbors_,          runs_,  directory_,   hops_,
           router_,   presence_, streams_,   forwarder_, links_,     broadcast_receiver_, flood_, distributor_, groups_,
           incoming_, outgoing_, statistics_}),
      introspection_({options_.max_packet_size, self_, guard_, neighbors_, runs_, directory_, router_, hops_,
                      reassembly_, streams_, receivers_, broadcast_receiver_, flood_, distributor_, groups_,
                      outgoing_.sends(), events_}),
      now_(now) {
  security::wipe(options_.keys);
}

}  // namespace adhoc_communication
