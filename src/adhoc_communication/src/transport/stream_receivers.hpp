// Packets of others for this robot: a receiver for each robot that they come from.
#pragma once

#include <memory>
#include <vector>

#include "busy_map.hpp"
#include "routing/router.hpp"
#include "transport/stream_receiver.hpp"

namespace adhoc_communication::transport {

class StreamReceivers {
 public:
  static constexpr std::size_t kMostReceivers = 1024;  ///< the one idle longest makes room

  StreamReceivers(const Identity& self, std::size_t largest_packet, routing::Router& router, Outbox& outbox,
                  Reassembly& reassembly)
      : self_(self), largest_packet_(largest_packet), router_(router), outbox_(outbox), reassembly_(reassembly) {}

  /// The packets that this segment makes deliverable, in order.
  std::vector<StreamReceiver::Complete> take(const wire::Data& data, Time now);
  /// The packet had to make room.
  void evicted(const Reassembly::Key& key, Time now);
  /// There is no way back to the robot: it is owed no acknowledgment.
  void forgo(const MacAddress& source);
  /// Sends the acknowledgments that are due.
  void acknowledge(Time now);
  void expire(Time now);
  Time next_deadline() const;
  void settle();

  std::size_t size() const { return receivers_.size(); }

 private:
  StreamReceiver& receiver_for(const wire::Data& data);
  void acknowledge(const MacAddress& source, StreamReceiver& receiver, std::size_t stream, Time now);

  const Identity& self_;
  std::size_t largest_packet_;
  routing::Router& router_;
  Outbox& outbox_;
  Reassembly& reassembly_;
  BusyMap<std::unique_ptr<StreamReceiver>> receivers_;
};

}  // namespace adhoc_communication::transport
