// The topics that other nodes of this robot publish, as far as was learned last.
#pragma once

#include <set>
#include <string>

#include "adhoc_communication/types.hpp"
#include "relay/local_topics.hpp"

namespace adhoc_communication {

/// They may start to publish a topic at any time, also one that packets were published on before. So of a topic that is
/// carried or refused already it is asked again, once a second for all of these; of any other one at once.
class OthersTopics {
 public:
  static constexpr Time kAskAgain = std::chrono::seconds(1);
  static constexpr Time kAskAgainAfterSilence = std::chrono::seconds(3);  ///< an answer was waited for in vain

  explicit OthersTopics(const LocalTopics& local) : local_(local) {}

  /// `carried`: packets are published on it already. Throws PayloadError when others publish it, or might.
  void check_free(const std::string& topic, bool carried, Time now);

 private:
  void ask(Time now);

  const LocalTopics& local_;
  std::set<std::string> topics_;
  bool answered_ = false;  ///< when last asked
  Time ask_again_{0};
};

}  // namespace adhoc_communication
