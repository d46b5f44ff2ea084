// The topics that other nodes of this robot use, as far as was learned last.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "adhoc_communication/types.hpp"
#include "relay/local_topics.hpp"

namespace adhoc_communication {

/// They may start to publish a topic at any time, also one that packets were published on before. So of a topic that is
/// carried or refused already it is asked again, once a second for all of these; of any other one at once. Asking waits
/// for nothing.
class OthersTopics {
 public:
  static constexpr Time kAskAgain = std::chrono::seconds(1);
  static constexpr Time kAskAgainAfterSilence = std::chrono::seconds(3);  ///< an answer was waited for in vain
  static constexpr Time kPatience = std::chrono::milliseconds(1500);      ///< with which packets wait for an answer

  explicit OthersTopics(LocalTopics& local) : local_(local) {}

  /// Of a topic that packets are published on already. Throws PayloadError when others publish it.
  void check_carried(const std::string& topic, Time now);
  /// Of any other topic: false when an answer has to be waited for. Throws PayloadError when others publish it, or
  /// might.
  bool check_new(const std::string& topic, Time now);
  /// As check_new(), of a topic that may be published whoever else does.
  bool knows_subscribers(Time now);
  std::size_t subscribers(const std::string& topic) const;

  /// An answer is to be looked for soon.
  bool waits() const { return asked_.has_value(); }
  /// Looks for an answer. True when what has waited for one is to go on, be it for want of patience.
  bool settle(Time now);

 private:
  void look(Time now);
  void ask(Time now);
  bool learned(Time now);

  LocalTopics& local_;
  TopicsInUse in_use_;
  bool answered_ = false;        ///< when last asked
  bool open_ = false;            ///< a question is
  std::optional<Time> asked_;    ///< an answer is waited for since then
  std::optional<Time> learned_;  ///< when the last one came, or was given up
  bool news_ = false;            ///< since settle()
  Time ask_again_{0};
};

}  // namespace adhoc_communication
