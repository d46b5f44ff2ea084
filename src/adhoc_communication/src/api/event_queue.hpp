// What the host has not taken yet of what has happened.
#pragma once

#include <deque>
#include <optional>

#include "adhoc_communication/types.hpp"

namespace adhoc_communication {

/// When it is full the oldest received packet is dropped. Ends of sends and changes of the team are few and must not be
/// lost.
class EventQueue {
 public:
  static constexpr std::size_t kMostEvents = 4096;
  static constexpr std::size_t kMostOctets = 32'000'000;  ///< of received packets, if it is more than one

  void add(Event event);
  std::optional<Event> next();

  std::size_t size() const { return events_.size(); }
  std::size_t octets() const { return octets_; }

 private:
  void drop_oldest_packet();

  std::deque<Event> events_;
  std::size_t octets_ = 0;  ///< payloads of the packets among them
};

}  // namespace adhoc_communication
