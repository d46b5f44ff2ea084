#include "medium/bursts.hpp"

#include <algorithm>
#include <cmath>

namespace adhoc_communication {
namespace {

Time exponential(Time mean, Random& random) {
  const double times = -std::log(1.0 - random.uniform());
  return Time(static_cast<Time::rep>(times * static_cast<double>(mean.count())));
}

}  // namespace

bool Bursts::bad(std::size_t a, std::size_t b, Time at) {
  if (!exist()) return false;
  const auto [low, high] = std::minmax(a, b);
  Link& link = links_[{low, high}];
  const Time length = kEpoch * (options_.good + options_.bad);
  const Time::rep epoch = at / length;
  if (epoch != link.epoch) begin(link, low, high, epoch, epoch * length);
  while (link.until <= at) change(link);
  return link.bad;
}

/// As it is at any time.
void Bursts::begin(Link& link, std::size_t a, std::size_t b, Time::rep epoch, Time epoch_begin) const {
  link.random = Random(seed_);
  for (const std::uint64_t number : {std::uint64_t{a}, std::uint64_t{b}, static_cast<std::uint64_t>(epoch)}) {
    link.random = Random(link.random.next() ^ number);
  }
  link.epoch = epoch;
  const double share =
      static_cast<double>(options_.bad.count()) / static_cast<double>((options_.good + options_.bad).count());
  link.bad = !link.random.chance(share);
  link.until = epoch_begin;
  change(link);
}

void Bursts::change(Link& link) const {
  link.bad = !link.bad;
  link.until += exponential(link.bad ? options_.bad : options_.good, link.random);
}

}  // namespace adhoc_communication
