// Packets from one robot to another.
#include <algorithm>
#include <cmath>

#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

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
  const double shares = shared ? static_cast<double>(std::min<std::size_t>(hops, 3)) : 1.0;
  const double bar = (hops == 1 ? 0.90 : 0.85) * (1 - loss) / shares;
  Row row;
  row.what = format("goodput over capacity, %.0f hops, loss %.0f %%", static_cast<double>(hops), loss * 100) +
             (shared ? ", shared channel" : "");
  row.bar = format(">= %.3f", bar);
  row.value = rate / capacity();
  row.unit = "1";
  row.holds = row.value >= bar;
  row.detail = format("%.2f Mbit/s of %.2f", rate * 1e-6, capacity() * 1e-6);
  return row;
}

}  // namespace

std::vector<Row> intact_rows(const Effort& effort) {
  std::vector<Row> rows;
  for (const std::size_t hops : {1, 3, 10}) {
    for (const double loss : {0.0, 0.1, 0.3}) rows.push_back(transfer(hops, loss, effort.trials));
  }
  return rows;
}

std::vector<Row> goodput_rows(const Effort&) {
  std::vector<Row> rows;
  for (const std::size_t hops : {1, 2, 3, 10}) {
    for (const double loss : {0.0, 0.1, 0.3}) rows.push_back(goodput(hops, loss, false));
  }
  for (const std::size_t hops : {2, 3, 10}) {
    for (const double loss : {0.0, 0.1, 0.3}) rows.push_back(goodput(hops, loss, true));
  }
  return rows;
}

}  // namespace adhoc_communication::bench
