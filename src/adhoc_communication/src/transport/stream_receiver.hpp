// Packets from one run of one robot, put together from segments and delivered in order, each once.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "transport/hop_sender.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::transport {

/// Octets of all unfinished packets together; segments beyond are not taken and will be sent again.
class AssemblyBudget {
 public:
  explicit AssemblyBudget(std::size_t octets) : left_(octets) {}
  bool take(std::size_t octets) {
    if (octets > left_) return false;
    left_ -= octets;
    return true;
  }
  void give_back(std::size_t octets) { left_ += octets; }
  std::size_t left() const { return left_; }

 private:
  std::size_t left_;
};

class StreamReceiver {
 public:
  static constexpr std::uint32_t kPacketsAhead = 1024;   ///< taken beyond the next one to deliver
  static constexpr std::uint32_t kSegmentsAhead = 4096;  ///< taken beyond the first missing one
  static constexpr int kSegmentsPerAcknowledgment = 64;
  static constexpr Time kLongestDelay = std::chrono::milliseconds(50);
  static constexpr Time kAbandoned = std::chrono::seconds(60);

  struct Complete {
    Bytes image;
    std::uint8_t hops;
  };

  StreamReceiver(wire::BootTag boot, std::size_t largest_packet, AssemblyBudget& budget)
      : boot_(boot), largest_packet_(largest_packet), budget_(budget) {}
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
  /// Drops unfinished packets whose sender went silent.
  void expire(Time now);
  Time last_used() const { return last_used_; }

 private:
  struct Assembly {
    std::uint32_t total = 0;
    std::uint16_t segment_size = 0;
    std::uint32_t missing = 0;
    std::uint32_t first_missing = 0;
    std::uint8_t hops = 1;
    std::vector<bool> present;
    Bytes octets;
  };
  struct Stream {
    bool started = false;
    std::uint32_t next = 0;
    std::map<std::uint32_t, Assembly> assemblies;  ///< by distance from `next` at all times: keys are packet numbers
    int unacknowledged = 0;
    Time due = Time::max();
    Time last_segment{0};
  };

  bool store(Stream& stream, const wire::Data& data);
  void drop(Stream& stream, std::map<std::uint32_t, Assembly>::iterator assembly);
  void move_base(Stream& stream, std::uint32_t base);
  void deliver(Stream& stream, std::vector<Complete>& out);

  wire::BootTag boot_;
  std::size_t largest_packet_;
  AssemblyBudget& budget_;
  std::array<Stream, kPriorities> streams_;
  Time last_used_{0};
};

}  // namespace adhoc_communication::transport
