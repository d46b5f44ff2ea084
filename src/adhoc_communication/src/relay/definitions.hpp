// Message definitions received from other robots, and messages that wait for theirs. No ROS, no thread, no clock.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <string>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {

/// A definition is identified by type and MD5 sum, whoever sent it; the first one received counts. Without room, the
/// robot that keeps most of what there is too much of loses its oldest: definitions, or messages that wait.
class Definitions {
 public:
  static constexpr std::size_t kMostDefinitions = 256;       ///< those that messages bring, too
  static constexpr std::size_t kMostOctets = 8'000'000;      ///< of all definitions
  static constexpr std::size_t kMostHeld = 64;               ///< messages that wait
  static constexpr std::size_t kMostHeldOctets = 8'000'000;  ///< of these, if it is more than one message
  static constexpr Time kPatience = std::chrono::seconds(10);
  static constexpr Time kAskAgain = std::chrono::seconds(1);

  /// Null when it is not known.
  const std::string* find(const TypeName& type) const;

  /// Keeps a definition and returns the messages that have waited for it, in order.
  std::vector<PacketReceived> learn(const TypeName& type, const std::string& definition, const std::string& source);

  /// Keeps a message until its definition is learnt. True when its sender has to be asked for the definition now.
  bool hold(PacketReceived packet, const TypeName& type, Time now);
  bool awaits_any() const { return !asked_.empty(); }
  /// Whether one that waits is among those.
  bool holds(const std::function<bool(const PacketReceived&)>& is_meant) const;
  bool awaits(const TypeName& type) const { return asked_.count(type) != 0; }

  /// Drops messages that have waited too long.
  void expire(Time now);
  /// Of whom which definition is to be asked for once more: it did not come, and perhaps no further message will.
  std::vector<std::pair<std::string, TypeName>> take_overdue(Time now);
  /// Messages dropped since the last call.
  std::uint64_t take_dropped();

 private:
  struct Known {
    TypeName type;
    std::string definition;
    std::string source;
  };
  struct Held {
    PacketReceived packet;
    TypeName type;
    Time since;
  };

  void forget_definition();
  void drop(std::deque<Held>::iterator held);
  void drop_oldest_of_most();
  void forget_unawaited();

  std::list<Known> known_;
  std::map<TypeName, std::list<Known>::iterator> by_type_;
  std::size_t octets_ = 0;
  std::deque<Held> held_;
  std::size_t held_octets_ = 0;
  std::map<TypeName, Time> asked_;  ///< for types of held messages, when their definition was asked for last
  std::uint64_t dropped_ = 0;
};

}  // namespace adhoc_communication
