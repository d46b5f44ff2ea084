// How long an urgent message takes while a map is on its way.
#include <algorithm>

#include "rows.hpp"
#include "transport/hop_sender.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

struct Case {
  std::size_t hops;
  double loss;
  int timers;  ///< retry timers that the worst hundredth may wait for
};

constexpr Case kCases[] = {{1, 0.0, 0},  {3, 0.0, 0}, {10, 0.0, 0}, {1, 0.1, 1},  {3, 0.1, 2},
                           {10, 0.1, 4}, {1, 0.3, 3}, {3, 0.3, 6},  {10, 0.3, 11}};

/// Air time of a frame of full size.
double air_time() { return 1500.0 * 8 / capacity(); }

double bar_of(const Case& measured) {
  return 2 * air_time() * static_cast<double>(measured.hops) +
         measured.timers * seconds(transport::HopSender::kShortestTimer);
}

/// Messages of a few octets at random times, about one every 40 ms, while one map after the other flows the same way.
class Latencies {
 public:
  Latencies(const Case& measured, std::uint64_t seed)
      : team_(radio(measured), seed), random_(seed), far_end_(measured.hops) {
    team_.add_line(measured.hops + 1);
    team_.on_event = [this](std::size_t robot, const Event& event) { take(robot, event); };
    team_.run_for(1s);
  }

  std::vector<double> measure(int messages) {
    keep_maps_flowing();
    team_.run_for(200ms);  // the first map fills the whole way
    for (int i = 0; i < messages; ++i) {
      keep_maps_flowing();
      sent_.push_back(team_.now());
      team_.send(0, Team::name(far_end_), Bytes{static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)},
                 Priority::kNormal, "urgent");
      team_.run_for(20ms + random_.delay(40ms));
    }
    team_.run_for(5s);
    return latencies_;
  }

 private:
  static MediumOptions radio(const Case& measured) {
    MediumOptions medium;
    medium.loss = measured.loss;
    return medium;
  }

  void keep_maps_flowing() {
    while (maps_ < 3) {
      team_.send(0, Team::name(far_end_), noise(1'000'000, 1), Priority::kBulk);
      ++maps_;
    }
  }

  void take(std::size_t robot, const Event& event) {
    const auto* packet = std::get_if<PacketReceived>(&event);
    if (packet == nullptr || robot != far_end_) return;
    if (packet->topic != "urgent") {
      --maps_;
    } else {
      const std::size_t number = std::size_t{packet->payload[0]} << 8 | packet->payload[1];
      latencies_.push_back(seconds(team_.now() - sent_[number]));
    }
  }

  Team team_;
  Random random_;
  std::size_t far_end_;
  int maps_ = 0;
  std::vector<Time> sent_;
  std::vector<double> latencies_;
};

Row latency(const Case& measured, int trials) {
  const int messages = 100;
  std::vector<double> all;
  for (int seed = 1; seed <= trials; ++seed) {
    const auto some = Latencies(measured, static_cast<std::uint64_t>(seed)).measure(messages);
    all.insert(all.end(), some.begin(), some.end());
  }
  const double bar = 1e3 * bar_of(measured);
  const double p99 = 1e3 * quantile(all, 0.99);
  const bool complete = all.size() == static_cast<std::size_t>(messages * trials);
  return {format("small message during a map, %.0f hops, loss %.0f %%: p99", static_cast<double>(measured.hops),
                 measured.loss * 100),
          format("<= %.2f", bar),
          p99,
          "ms",
          p99 <= bar && complete,
          format("p50 %.2f ms, max %.2f ms", 1e3 * quantile(all, 0.5), 1e3 * quantile(all, 1.0)) +
              format(", arrived %.0f of %.0f", static_cast<double>(all.size()), messages * trials)};
}

/// Seconds that a relay takes for 500 kB of its own, over a hop that loses nothing, while `sources` robots send through
/// it to another robot, over a hop of that loss; many if it does not end.
double own_transfer(std::size_t sources, double loss, std::uint64_t seed) {
  EngineOptions options;
  options.join_groups_automatically = false;
  Team team({}, seed);
  team.add(options, 0.0);
  team.add(options, 8.0);
  team.add(options, 0.0, 8.0);
  for (std::size_t i = 0; i < sources; ++i) team.add(options, -5.0, i % 2 == 0 ? 5.0 : -5.0);
  team.medium().set_link_loss(0, 1, loss);
  team.run_for(2s);
  for (std::size_t i = 0; i < sources; ++i) {
    for (int packet = 0; packet < 4; ++packet) {
      team.send(3 + i, "robot_1", noise(8'000'000, seed), Priority::kBulk);
    }
  }
  team.run_for(500ms);
  const Time begin = team.now();
  const SendId own = team.send(0, "robot_2", noise(500'000, seed), Priority::kBulk);
  team.run_until_done([&] { return team.finished(0, own) != nullptr; }, 60s);
  const SendFinished* end = team.finished(0, own);
  return end != nullptr && end->delivered ? seconds(team.now() - begin) : 1e9;
}

/// Over the time that its fair share would take.
Row own_share(std::size_t sources, double loss, int seeds) {
  std::vector<double> ratios;
  for (int seed = 1; seed <= seeds; ++seed) {
    const auto number = static_cast<std::uint64_t>(seed);
    const double fair = own_transfer(0, 0.0, number) * static_cast<double>(sources + 1);
    ratios.push_back(own_transfer(sources, loss, number) / fair);
  }
  const double worst = quantile(ratios, 1.0);
  const std::string where = loss > 0 ? format(" whose next hop loses %.0f %%", loss * 100) : "";
  return {format("own 500 kB of a relay for %.0f others", static_cast<double>(sources)) + where +
              ", over its fair share: worst",
          "<= 2.00",
          worst,
          "1",
          worst <= 2.0,
          format("median %.2f", quantile(ratios, 0.5))};
}

}  // namespace

void measure_priority(const Effort& effort, Rows& rows) {
  for (const double loss : {0.0, 0.1, 0.3}) {
    for (const std::size_t sources : {1, 2, 4}) rows.add(own_share(sources, loss, std::max(10, effort.trials / 2)));
  }
  for (const Case& measured : kCases) rows.add(latency(measured, std::max(3, effort.trials / 2)));
}

}  // namespace adhoc_communication::bench
