// Loss that comes in bursts: Gilbert and Elliott's channel, which is good for a while and bad for a while.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "adhoc_communication/types.hpp"
#include "random.hpp"

namespace adhoc_communication {

struct BurstOptions {
  Time good{0};       ///< for which a link is good, on average
  Time bad{0};        ///< for which it is bad, on average; 0: never
  double loss = 1.0;  ///< probability per frame while it is bad
};

/// Both directions of a link are bad at the same times. The times last as an exponential distribution has them, and
/// follow from the seed alone, whatever is sent.
class Bursts {
 public:
  Bursts(const BurstOptions& options, std::uint64_t seed) : options_(options), seed_(seed) {}

  double loss() const { return options_.loss; }
  bool exist() const { return options_.bad > Time(0); }
  /// For each link, the times asked about may not fall.
  bool bad(std::size_t a, std::size_t b, Time at);

 private:
  struct Link {
    Random random{0};
    Time::rep epoch = -1;  ///< of kEpoch mean changes each, which are drawn on their own: so a pause costs nothing
    bool bad = false;
    Time until{0};
  };
  static constexpr int kEpoch = 1000;

  void begin(Link& link, std::size_t a, std::size_t b, Time::rep epoch, Time epoch_begin) const;
  void change(Link& link) const;

  BurstOptions options_;
  std::uint64_t seed_;
  std::map<std::pair<std::size_t, std::size_t>, Link> links_;
};

}  // namespace adhoc_communication
