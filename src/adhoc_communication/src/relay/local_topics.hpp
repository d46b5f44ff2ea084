// The topics of this robot, as whoever hosts a relay offers them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
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

  /// Nodes can find it. Until then, what is published reaches nobody.
  virtual bool offered() const { return true; }
  virtual std::string refusal() const { return {}; }  ///< why it never can be offered; empty if it can
  virtual std::size_t subscribers() const = 0;        ///< that have connected
  virtual void publish(const SerializedMessage& message) = 0;
  /// Hands subscribers what they can take of what waits for them. True while something waits.
  virtual bool serve() { return false; }
  /// Messages that were dropped since the last call because a subscriber did not take them.
  virtual std::uint64_t take_dropped() { return 0; }
};

/// What nodes of this robot do with its topics, by full names.
struct TopicsInUse {
  std::set<std::string> of_others;                 ///< that nodes besides this one publish
  std::map<std::string, std::size_t> subscribers;  ///< that have connected or are to
};

/// Nothing here waits for an answer of somebody else.
class LocalTopics {
 public:
  LocalTopics() = default;
  virtual ~LocalTopics() = default;
  LocalTopics(const LocalTopics&) = delete;
  LocalTopics& operator=(const LocalTopics&) = delete;

  /// One topic has one name. Throws PayloadError for what is no valid name.
  virtual std::string full_name(const std::string& topic) const = 0;
  /// Begins to learn what is in use; the question before has been answered.
  virtual void ask() = 0;
  struct Answer {
    std::optional<TopicsInUse> in_use;  ///< nothing when that cannot be learned now
  };
  /// The answer, once; nothing before it is there, which may take for ever.
  virtual std::optional<Answer> take_answer() = 0;
  /// A topic of the type of `message`.
  virtual std::unique_ptr<Publication> advertise(const std::string& full_name, const SerializedMessage& message,
                                                 bool latched) = 0;
};

}  // namespace adhoc_communication
