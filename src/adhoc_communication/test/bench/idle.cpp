// What presence alone costs.
#include <algorithm>
#include <cmath>

#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

Row idle() {
  Team team;
  for (int i = 0; i < 3; ++i) team.add();
  team.run_for(10s);
  const std::uint64_t polls = team.polls();
  const std::uint64_t octets = team.engine(0).statistics().bytes_sent;
  team.run_for(60s);
  const double per_second = static_cast<double>(team.polls() - polls) / 60.0 / 3.0;
  const double bits = 8.0 * static_cast<double>(team.engine(0).statistics().bytes_sent - octets) / 60.0;
  return {
      "wake-ups of an idle engine with two neighbours, besides frames", "<= 20", per_second, "1/s", per_second <= 20,
      format("%.2f kbit/s on the air per robot", bits * 1e-3)};
}

}  // namespace

std::vector<Row> idle_rows(const Effort&) { return {idle()}; }

}  // namespace adhoc_communication::bench
