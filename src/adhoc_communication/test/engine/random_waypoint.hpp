// Robots that wander: each goes straight to a random place at a random speed, rests, and chooses the next one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "adhoc_communication/types.hpp"
#include "propagation/position.hpp"
#include "random.hpp"

namespace adhoc_communication {

struct WaypointOptions {
  double width = 100.0;  ///< metres
  double height = 100.0;
  double slowest = 0.5;  ///< m/s, above zero: slower robots would gather on ever longer legs
  double fastest = 1.5;
  Time longest_rest = std::chrono::seconds(5);
};

/// The way of one robot. Time must not go back.
class RandomWaypoint {
 public:
  RandomWaypoint(const WaypointOptions& options, std::uint64_t seed)
      : options_(options), random_(seed), begin_(random_place()), end_(begin_) {}

  Position at(Time now) {
    while (now >= rests_until_) choose_next_leg();
    const double length = static_cast<double>((arrives_at_ - starts_at_).count());
    const double share = std::min(1.0, static_cast<double>((now - starts_at_).count()) / length);
    return {begin_.x + share * (end_.x - begin_.x), begin_.y + share * (end_.y - begin_.y)};
  }

 private:
  Position random_place() {
    const double x = random_.uniform() * options_.width;
    return {x, random_.uniform() * options_.height};
  }

  void choose_next_leg() {
    begin_ = end_;
    end_ = random_place();
    const double speed = options_.slowest + random_.uniform() * (options_.fastest - options_.slowest);
    const double seconds = distance_between(begin_, end_) / speed;
    starts_at_ = rests_until_;
    arrives_at_ = starts_at_ + std::max(Time(1), Time(static_cast<Time::rep>(seconds * 1e9)));
    rests_until_ = arrives_at_ + random_.delay(options_.longest_rest);
  }

  WaypointOptions options_;
  Random random_;
  Position begin_;
  Position end_;
  Time starts_at_{0};
  Time arrives_at_{0};
  Time rests_until_{0};
};

}  // namespace adhoc_communication
