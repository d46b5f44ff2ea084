// Finding routes, and finding new ones.
#include <algorithm>
#include <cmath>

#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

/// A square: 0 - 1 - 3 and 0 - 2 - 3. The relay in use dies while packets of 1 kB flow.
Row repair(double loss, int seeds) {
  std::vector<double> times;
  int failed = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    MediumOptions medium;
    medium.loss = loss;
    Team team(medium, static_cast<std::uint64_t>(seed));
    team.add({}, 0, 0);
    team.add({}, 7, 4);
    team.add({}, 7, -4);
    team.add({}, 14, 0);
    std::size_t relay = 0;
    team.on_transmission = [&](std::size_t robot, const Frame& frame) {
      if ((robot == 1 || robot == 2) && frame.bytes.size() > 1000) relay = robot;
    };
    std::vector<SendId> ids;
    const auto flow = [&](Time duration) {
      for (const Time end = team.now() + duration; team.now() < end;) {
        ids.push_back(team.send(0, "robot_3", noise(1200, 3)));
        team.run_for(2ms);
      }
    };
    team.run_for(1s);
    flow(300ms + Time(seed * 1'000'000));
    const Time killed = team.now();
    const std::size_t before = team.received(3).size();
    team.kill(relay);
    flow(400ms);
    team.run_for(20s);
    // Packets already past the relay are not the repair.
    Time repaired = Time::max();
    for (std::size_t i = before; i < team.received(3).size(); ++i) {
      const Time at = team.received(3)[i].at;
      if (at > killed + 5ms && at < repaired) repaired = at;
    }
    for (const SendId id : ids) {
      const SendFinished* finished = team.finished(0, id);
      if (finished == nullptr || !finished->delivered) ++failed;
    }
    times.push_back(seconds(repaired - killed));
  }
  Row row;
  row.what = format("traffic flows again after the relay dies, loss %.0f %%, p99", loss * 100);
  row.bar = "<= 1.0";
  row.value = quantile(times, 0.99);
  row.unit = "s";
  row.holds = row.value <= 1.0 && failed == 0;
  row.detail =
      format("p50 %.3f s, max %.3f s, messages lost: %.0f", quantile(times, 0.5), quantile(times, 1.0), failed);
  return row;
}

Row absent() {
  Team team;
  team.add_line(3);
  team.run_for(1s);
  const Time start = team.now();
  const SendId id = team.send(0, "robot_7", text("x"));
  team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 20s);
  const double time = seconds(team.now() - start);
  return {"absent destination reported",
          "<= 2.0",
          time,
          "s",
          time <= 2.0,
          team.finished(0, id) ? team.finished(0, id)->reason : "never"};
}

Row first_route(double loss, int seeds) {
  std::vector<double> times;
  for (int seed = 1; seed <= seeds; ++seed) {
    MediumOptions medium;
    medium.loss = loss;
    Team team(medium, static_cast<std::uint64_t>(seed));
    EngineOptions cold;
    cold.join_groups_automatically = false;  // joining would find the route before
    team.add_line(5, cold);
    team.run_for(4s);
    const Time start = team.now();
    team.send(0, "robot_4", text("x"));
    team.run_until_done([&] { return !team.received(4).empty(); }, 20s);
    times.push_back(seconds(team.now() - start));
  }
  const double bar = loss > 0 ? 0.5 : 0.05;
  const double p50 = quantile(times, 0.5);
  return {format("first message over 4 hops, loss %.0f %%, p50", loss * 100),
          format("<= %.2f", bar),
          p50,
          "s",
          p50 <= bar,
          format("p99 %.3f s", quantile(times, 0.99))};
}

}  // namespace

std::vector<Row> route_rows(const Effort& effort) {
  const int trials = effort.trials;
  std::vector<Row> rows;
  for (const double loss : {0.0, 0.1}) rows.push_back(repair(loss, trials));
  for (const double loss : {0.0, 0.3}) rows.push_back(first_route(loss, trials));
  rows.push_back(absent());
  return rows;
}

}  // namespace adhoc_communication::bench
