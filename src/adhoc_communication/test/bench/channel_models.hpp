// Channels that lose, delay and fade in other ways than by chance for each frame.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "adhoc_communication/options.hpp"
#include "medium/medium.hpp"

namespace adhoc_communication::bench {

/// What changes on a medium while it is used. `now` never falls.
using Course = std::function<void(Medium&, Time now)>;

struct ChannelModel {
  std::string name;
  MediumOptions medium;
  std::function<Course()> course = [] { return [](Medium&, Time) {}; };  ///< a fresh one for each run
  EngineOptions engine;
  Time outage{0};  ///< of the first link of a line, in each kFadePeriod; 0: none
};

constexpr Time kFadePeriod = std::chrono::seconds(6);
constexpr Time kCourseStep = std::chrono::milliseconds(5);  ///< within which a change takes effect

/// Whether the first link of a line is cut.
bool faded(Time outage, Time now);
std::vector<ChannelModel> channel_models();

/// Seconds for `octets` along a line of nodes 8 m apart, from `begin` on, when each sender knows at once what has
/// arrived and repeats nothing else, in frames of the same size and with the same headers. Where frames are delayed, a
/// hop has at most as many in each round trip as an acknowledgment covers; the last one and its answer take that long.
double ideal_time(const ChannelModel& channel, std::size_t hops, std::size_t octets, std::uint64_t seed, Time begin);

}  // namespace adhoc_communication::bench
