// What presence alone costs.
#include <algorithm>
#include <cmath>

#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

std::vector<Row> two_neighbours() {
  Team team;
  for (int i = 0; i < 3; ++i) team.add();
  team.run_for(10s);
  const std::uint64_t polls = team.polls();
  const std::uint64_t octets = team.engine(0).statistics().bytes_sent;
  team.run_for(60s);
  const double per_second = static_cast<double>(team.polls() - polls) / 60.0 / 3.0;
  const double bits = 8.0 * static_cast<double>(team.engine(0).statistics().bytes_sent - octets) / 60.0;
  return {{"wake-ups of an idle engine with two neighbours, besides frames", "<= 20", per_second, "1/s",
           per_second <= 20, "three robots, members of each other's groups"},
          {"idle robot with two neighbours, on the air", "<= 2", bits * 1e-3, "kbit/s", bits <= 2000,
           "beacons once a second"}};
}

Row crowd() {
  MediumOptions medium;
  medium.bit_rate = 6e6;
  Team team(medium);
  EngineOptions options;
  options.join_groups_automatically = false;  // idle groups put nothing on the air, but joining takes long to compute
  for (int i = 0; i < 100; ++i) team.add(options);
  team.run_for(20s);
  const Time before = team.medium().counters().air_time;
  team.run_for(30s);
  const double share = seconds(team.medium().counters().air_time - before) / 30.0;
  return {"100 idle robots in range of each other at 6 Mbit/s: share of the air",
          "<= 0.05",
          share,
          "1",
          share <= 0.05,
          format("%.0f octets a second per robot",
                 static_cast<double>(team.engine(0).statistics().bytes_sent) / seconds(team.now()))};
}

}  // namespace

void measure_idle(const Effort&, Rows& rows) {
  for (const Row& row : two_neighbours()) rows.add(row);
  rows.add(crowd());
}

}  // namespace adhoc_communication::bench
