// Measures the engine on the simulated radio in virtual time: 50 Mbit/s, 50 us per frame, own channel for each sender.
//
//   bench_engine [--seeds N] [--json FILE]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "team.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;

struct Row {
  std::string what;
  std::string bar;
  double value;
  std::string unit;
  bool holds;
  std::string detail;
};

double seconds(Time time) { return static_cast<double>(time.count()) * 1e-9; }

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return -1;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

std::string format(const char* pattern, double a, double b = 0, double c = 0) {
  char text[128];
  std::snprintf(text, sizeof text, pattern, a, b, c);
  return text;
}

/// Time on the air of the smallest number of full frames that hold `octets`, with every frame sent 1/(1-p) times.
double air_bound(std::size_t octets, double loss) {
  const double frames = std::ceil(static_cast<double>(octets) / 1500.0);
  return frames * (1500.0 * 8 / 50e6 + 50e-6) / (1 - loss);
}

Row transfer(std::size_t hops, double loss, int seeds) {
  std::vector<double> times;
  int intact = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    MediumOptions medium;
    medium.loss = loss;
    Team team(medium, static_cast<std::uint64_t>(seed));
    team.add_line(hops + 1);
    team.run_for(1s);
    const Bytes payload = noise(1'000'000, static_cast<std::uint64_t>(seed));
    const Time start = team.now();
    const SendId id = team.send(0, Team::name(hops), payload, Priority::kBulk);
    team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s);
    const SendFinished* finished = team.finished(0, id);
    if (finished == nullptr || !finished->delivered) continue;
    team.run_for(500ms);
    if (team.received(hops).size() == 1 && team.received(hops)[0].packet.payload == payload) ++intact;
    times.push_back(seconds(team.finished_at(0, id) - start));
  }
  Row row;
  row.what = format("1 MB incompressible, %.0f hops, loss %.0f %%: intact", static_cast<double>(hops), loss * 100);
  row.bar = std::to_string(seeds) + " of " + std::to_string(seeds);
  row.value = intact;
  row.unit = "transfers";
  row.holds = intact == seeds;
  row.detail = format("time p50 %.3f s, p95 %.3f s, max %.3f s", quantile(times, 0.5), quantile(times, 0.95),
                      quantile(times, 1.0)) +
               format("; air bound of one hop %.3f s", air_bound(1'000'000, loss));
  return row;
}

Row goodput(std::size_t hops, double loss, bool shared) {
  MediumOptions medium;
  medium.loss = loss;
  medium.shared = shared;
  Team team(medium, 5);
  team.add_line(hops + 1);
  team.run_for(1s);
  std::size_t sent = 0;
  const Time start = team.now();
  std::vector<SendId> ids;
  for (std::uint64_t i = 0; i < 20; ++i, sent += 1'000'000) {
    ids.push_back(team.send(0, Team::name(hops), noise(1'000'000, i), Priority::kBulk));
  }
  team.run_until_done([&] { return team.finished(0, ids.back()) != nullptr; }, 300s);
  const double rate = 8.0 * static_cast<double>(sent) / seconds(team.now() - start);
  const double capacity = 1500.0 * 8 / (1500.0 * 8 / 50e6 + 50e-6);
  const double shares = shared ? static_cast<double>(std::min<std::size_t>(hops, 3)) : 1.0;
  const double bar = (hops == 1 ? 0.90 : 0.85) * (1 - loss) / shares;
  Row row;
  row.what = format("goodput over capacity, %.0f hops, loss %.0f %%", static_cast<double>(hops), loss * 100) +
             (shared ? ", shared channel" : "");
  row.bar = format(">= %.3f", bar);
  row.value = rate / capacity;
  row.unit = "1";
  row.holds = row.value >= bar;
  row.detail = format("%.2f Mbit/s of %.2f", rate * 1e-6, capacity * 1e-6);
  return row;
}

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

std::string json(const std::vector<Row>& rows) {
  std::string out = "[\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& row = rows[i];
    out += "  {\"what\": \"" + row.what + "\", \"bar\": \"" + row.bar + "\", \"value\": " + format("%.6g", row.value) +
           ", \"unit\": \"" + row.unit + "\", \"holds\": " + (row.holds ? "true" : "false") + ", \"detail\": \"" +
           row.detail + "\"}" + (i + 1 < rows.size() ? ",\n" : "\n");
  }
  return out + "]\n";
}

int run(int seeds, const std::string& file) {
  std::vector<Row> rows;
  const auto add = [&](const Row& row) {
    std::printf("%-62s %-10s %10.4g %-9s %s  %s\n", row.what.c_str(), row.bar.c_str(), row.value, row.unit.c_str(),
                row.holds ? "holds " : "MISSED", row.detail.c_str());
    std::fflush(stdout);
    rows.push_back(row);
  };
  for (const std::size_t hops : {1, 3}) {
    for (const double loss : {0.0, 0.1, 0.3}) add(transfer(hops, loss, seeds));
  }
  for (const std::size_t hops : {1, 3}) {
    for (const double loss : {0.0, 0.1, 0.3}) add(goodput(hops, loss, false));
  }
  add(goodput(3, 0.0, true));
  add(goodput(3, 0.1, true));
  for (const double loss : {0.0, 0.1, 0.3}) add(repair(loss, seeds));
  for (const double loss : {0.0, 0.3}) add(first_route(loss, seeds));
  add(absent());
  add(idle());
  if (!file.empty()) std::ofstream(file) << json(rows);
  return std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.holds; }) ? 0 : 1;
}

}  // namespace
}  // namespace adhoc_communication

int main(int argc, char** argv) {
  int seeds = 20;
  std::string file;
  for (int i = 1; i < argc; i += 2) {
    if (i + 1 < argc && std::strcmp(argv[i], "--seeds") == 0 && std::atoi(argv[i + 1]) > 0) {
      seeds = std::atoi(argv[i + 1]);
    } else if (i + 1 < argc && std::strcmp(argv[i], "--json") == 0) {
      file = argv[i + 1];
    } else {
      std::fprintf(stderr, "usage: bench_engine [--seeds N] [--json FILE]\n");
      return 2;
    }
  }
  return adhoc_communication::run(seeds, file);
}
