// The topics of this robot, as whoever hosts a relay offers them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "relay/message.hpp"

namespace adhoc_communication {

/// A topic that nodes of this robot can subscribe to, until this is destroyed.
class Publication {
 public:
  Publication() = default;
  virtual ~Publication() = default;
  Publication(const Publication&) = delete;
  Publication& operator=(const Publication&) = delete;

  virtual std::size_t subscribers() const = 0;  ///< that have connected
  virtual void publish(const SerializedMessage& message) = 0;
  /// Hands subscribers what they can take of what waits for them. True while something waits.
  virtual bool serve() { return false; }
  /// Messages that were dropped since the last call because a subscriber did not take them.
  virtual std::uint64_t take_dropped() { return 0; }
};

class LocalTopics {
 public:
  LocalTopics() = default;
  virtual ~LocalTopics() = default;
  LocalTopics(const LocalTopics&) = delete;
  LocalTopics& operator=(const LocalTopics&) = delete;

  /// One topic has one name. Throws PayloadError for what is no valid name.
  virtual std::string full_name(const std::string& topic) const = 0;
  /// What nodes of this robot besides this one publish, by full names; nothing when that cannot be learned now.
  virtual std::optional<std::set<std::string>> of_others() const = 0;
  virtual std::size_t subscribers(const std::string& full_name) const = 0;  ///< that have connected or are to
  /// A topic of the type of `message`. Throws PayloadError.
  virtual std::unique_ptr<Publication> advertise(const std::string& full_name, const SerializedMessage& message,
                                                 bool latched) = 0;
};

}  // namespace adhoc_communication
