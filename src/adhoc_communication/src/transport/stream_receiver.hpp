// Packets from one run of one robot, put together from segments and delivered in order, each once.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "routing/sequence_number.hpp"
#include "transport/assembly.hpp"
#include "transport/hop_sender.hpp"
#include "transport/reassembly.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

class StreamReceiver {
 public:
  static constexpr std::uint32_t kPacketsAhead = 1024;  ///< taken beyond the next one to deliver
  static constexpr int kSegmentsPerAcknowledgment = 64;
  static constexpr Time kShortestDelay = std::chrono::milliseconds(50);
  static constexpr Time kLongestDelay = std::chrono::milliseconds(300);
  static constexpr Time kAbandoned = std::chrono::seconds(60);

  struct Complete {
    Bytes image;
    std::uint8_t hops;
  };

  StreamReceiver(const MacAddress& source, wire::BootTag boot, std::size_t largest_packet, Reassembly& reassembly)
      : source_(source), boot_(boot), largest_packet_(largest_packet), reassembly_(reassembly) {}
  ~StreamReceiver();
  StreamReceiver(const StreamReceiver&) = delete;
  StreamReceiver& operator=(const StreamReceiver&) = delete;

  wire::BootTag boot() const { return boot_; }
  /// The packets that this segment makes deliverable, in order.
  std::vector<Complete> take(const wire::Data& data, Time now);
  /// When the acknowledgment of a stream is due; Time::max() if none is owed.
  Time due(std::size_t stream) const { return streams_[stream].due; }
  Time next_deadline() const;
  void postpone(std::size_t stream, Time until) { streams_[stream].due = until; }
  void forgo(std::size_t stream) { streams_[stream].due = Time::max(); }
  /// Source and destination are left to the caller.
  wire::TransportAcknowledgment acknowledge(std::size_t stream);
  /// The packet had to make room: its sender is told to begin it anew.
  void evicted(std::size_t stream, std::uint32_t packet, Time now);
  /// Drops unfinished packets whose sender went silent.
  void expire(Time now);
  Time last_used() const { return last_used_; }

 private:
  /// A packet that was dropped or not admitted is begun anew by its sender, and what it says of an attempt before does
  /// not count.
  struct Incoming {
    Assembly assembly;
    std::uint8_t attempt = 0;
    std::uint8_t hops = 1;
  };
  using Packets = std::map<std::uint32_t, Incoming, routing::SequenceOrder>;
  struct Stream {
    bool started = false;
    std::uint32_t next = 0;
    Packets packets;
    std::map<std::uint32_t, std::uint8_t, routing::SequenceOrder> refused;  ///< by packet: the attempt
    int unacknowledged = 0;
    Time due = Time::max();
    Time last_segment{0};
    Time spacing{0};  ///< of segments, smoothed
  };
  enum class Stored { kFresh, kRepeated, kRefused, kRefusedBefore };

  Stored store(std::size_t index, const wire::Data& data, Time now);
  Incoming* packet_of(std::size_t index, const wire::Data& data, Time now);
  Reassembly::Key key(std::size_t stream, std::uint32_t packet) const {
    return {source_, boot_, static_cast<std::uint8_t>(stream), packet};
  }
  void drop(std::size_t index, Packets::iterator packet);
  void move_base(std::size_t index, std::uint32_t base);
  void deliver(std::size_t index, std::vector<Complete>& out);
  static Time delay(const Stream& stream);
  static wire::PartialPacket partial_of(std::uint32_t number, const Incoming& packet);

  MacAddress source_;
  wire::BootTag boot_;
  std::size_t largest_packet_;
  Reassembly& reassembly_;
  std::array<Stream, kPriorities> streams_;
  Time last_used_{0};
};

}  // namespace adhoc_communication::transport
