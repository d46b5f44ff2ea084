// Packets of the host, and letters of groups, from their start to their end.
#pragma once

#include <string>
#include <vector>

#include "api/event_queue.hpp"
#include "api/sends.hpp"
#include "multicast/group_traffic.hpp"
#include "transport/broadcast.hpp"
#include "transport/flood.hpp"
#include "transport/streams.hpp"

namespace adhoc_communication {

/// Hands each packet to the layer that carries it, and tells the host once how it has ended.
class Outgoing {
 public:
  /// Where packets go.
  struct Carriers {
    transport::Streams& streams;
    transport::BroadcastSenders& broadcasts;
    transport::FloodRelay& floods;
    multicast::GroupTraffic& groups;
  };

  /// `segment_size`, `longest_flood`: octets that one frame takes of a packet for everybody in range, and of a flood.
  Outgoing(const Identity& self, std::size_t max_packet_size, std::uint16_t segment_size, std::size_t longest_flood,
           const Carriers& carriers, EventQueue& events, Statistics& statistics)
      : self_(self),
        segment_size_(segment_size),
        longest_flood_(longest_flood),
        streams_(carriers.streams),
        broadcasts_(carriers.broadcasts),
        floods_(carriers.floods),
        groups_(carriers.groups),
        events_(events),
        statistics_(statistics),
        sends_(self.name, max_packet_size) {}

  SendId send(SendRequest request, Time now);
  SendId broadcast(BroadcastRequest request, Time now);
  void join(const std::string& group, Time now);
  void leave(const std::string& group, Time now);

  /// A layer tells the end of a packet; nothing happens to one that has ended before.
  void finish(SendId id, bool delivered, const std::string& reason, Time now) {
    finish(id, delivered, reason, now, false);
  }
  /// What groups have found out since: letters to send, ends of sends and of changes.
  void settle(Time now);
  /// Floods that are out, or have waited too long.
  void settle_floods();
  /// Packets whose lifetime is over.
  void expire(Time now);
  Time next_deadline() const { return sends_.next_deadline(); }

  /// The run ends: so does everything that the host waits for.
  void end(const std::string& reason, Time now);
  void succeed(const Outgoing& former) { sends_.succeed(former.sends_); }

  const Sends& sends() const { return sends_; }

 private:
  SendId refuse(std::string reason);
  void start(SendId id, const transport::Image& image, Time now);
  bool take_place(SendId id, const std::string& topic, const transport::Image& image, Time now);
  bool replace(SendId former, SendId id, const transport::Image& image, Time now);
  void cancel(SendId id, Time now);
  std::string cancel_group_send(SendId id, Time now);
  void finish(SendId id, bool delivered, const std::string& reason, Time now, bool superseded);
  void finish(const multicast::GroupSendEnd& end);

  const Identity& self_;
  std::uint16_t segment_size_;
  std::size_t longest_flood_;
  transport::Streams& streams_;
  transport::BroadcastSenders& broadcasts_;
  transport::FloodRelay& floods_;
  multicast::GroupTraffic& groups_;
  EventQueue& events_;
  Statistics& statistics_;
  Sends sends_;
  std::uint32_t next_flood_id_ = 0;
};

}  // namespace adhoc_communication
