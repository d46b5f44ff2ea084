// Who has sent latched messages to the own group, and who of them still has to hear of which new member.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "adhoc_communication/types.hpp"
#include "relay/message.hpp"

namespace adhoc_communication {

/// Only the root of a group knows when a robot joins it. It tells the sources of latched messages, who then send the
/// newest of each to that member alone. Word that does not arrive is sent again for as long as both are there.
class GroupNews {
 public:
  static constexpr std::size_t kMostSources = 64;  ///< further ones are not told
  static constexpr std::size_t kMostWords = 1024;  ///< not arrived yet; of further members nobody is told
  static constexpr std::size_t kMostUnderWay = 4;
  static constexpr Time kRetry = std::chrono::seconds(1);

  /// A packet of the own group has come.
  void heard(const PacketReceived& packet);
  void joined(const std::string& member, Time now);
  void left(const std::string& member);
  void lost(const std::string& robot);

  /// The next word, which is under way by this number until its end is told.
  std::optional<SendRequest> next(std::uint64_t number, Time now);
  /// True if the number was that of a word.
  bool ended(std::uint64_t number, bool delivered, Time now);
  /// Time::max() when nothing is to be said.
  Time next_deadline() const;

  /// The member that a word from a root names. Throws PayloadError.
  static std::string member_in(const PacketReceived& word);

 private:
  using Word = std::pair<std::string, std::string>;  ///< source and member
  struct UnderWay {
    Word word;
    bool of_use = true;  ///< to be repeated if it does not arrive
  };

  template <typename Predicate>
  void drop(Predicate concerns);

  std::set<std::string> sources_;
  std::map<Word, Time> due_;
  std::map<std::uint64_t, UnderWay> under_way_;
};

}  // namespace adhoc_communication
