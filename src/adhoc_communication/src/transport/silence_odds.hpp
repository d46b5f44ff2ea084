// Whether it tells anything that nothing is heard of a neighbour: on a crowded channel that happens by chance.
#pragma once

#include <algorithm>

namespace adhoc_communication::transport {

/// How likely it is that all that has gone unanswered since something was heard did so by chance, by how often that
/// happened before. To be asked while something is outstanding, which counts as one more.
class SilenceOdds {
 public:
  static constexpr double kByChance = 0.003;  ///< the odds at which silence counts as more
  static constexpr double kWorstLoss = 0.8;   ///< a worse link is none to hold on to
  static constexpr double kHardly = 0.05;     ///< share of the transmissions; of nothing known it is 0

  /// `loss`: share of the transmissions that were not answered up to now.
  void heard(double loss) { loss_ = chance_ = std::min(loss, kWorstLoss); }
  void unanswered() { chance_ *= loss_; }
  bool tells() const { return chance_ <= kByChance; }
  /// Hardly a transmission went unanswered when something was heard last.
  bool hardly_lost() const { return loss_ < kHardly; }

 private:
  double loss_ = 0.0;
  double chance_ = 0.0;
};

}  // namespace adhoc_communication::transport
