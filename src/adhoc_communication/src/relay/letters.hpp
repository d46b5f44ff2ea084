// What the relays of two robots write to one another, besides messages.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "adhoc_communication/types.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {

/// Nobody waits for a letter: one that does not arrive, or for which there is no room, is written again when its reason
/// comes again.
class Letters {
 public:
  static constexpr std::size_t kMostWaiting = 64;   ///< of each kind
  static constexpr std::size_t kMostUnderWay = 16;  ///< likewise

  /// Asks for the definition of a message that the robot has sent.
  void ask(const std::string& robot, const TypeName& type);
  /// The definition that was asked for.
  void answer(const std::string& robot, const TypeName& type, const std::string& definition);

  /// The next one, which is under way by this number until its end is told.
  std::optional<SendRequest> next(std::uint64_t number);
  /// True if the number was that of a letter.
  bool ended(std::uint64_t number);
  bool ready() const;

 private:
  enum Kind : std::size_t { kQuestion, kAnswer, kKinds };
  struct Box {
    std::deque<SendRequest> waiting;
    std::size_t under_way = 0;

    bool ready() const { return !waiting.empty() && under_way < kMostUnderWay; }
  };

  void post(Kind kind, SendRequest letter);

  std::array<Box, kKinds> boxes_;
  std::map<std::uint64_t, Kind> under_way_;
};

}  // namespace adhoc_communication
