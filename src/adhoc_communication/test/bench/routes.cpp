// Finding routes, and finding new ones.
#include <algorithm>
#include <cstdlib>

#include "any_radio.hpp"
#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMessage = 10'000;
constexpr int kKillsPerTrial = 15;

/// A square, 0 - 1 - 3 and 0 - 2 - 3, in which 0 sends to 3.
class Square {
 public:
  Square(const MediumOptions& medium, Time interval, std::uint64_t seed) : interval_(interval), team_(medium, seed) {
    team_.add({}, 0, 0);
    team_.add({}, 7, 4);
    team_.add({}, 7, -4);
    team_.add({}, 14, 0);
    team_.on_transmission = [this](std::size_t robot, const Frame& frame) {
      if ((robot == 1 || robot == 2) && frame.bytes.size() > 1000) relay_ = robot;
    };
    team_.run_for(1s);
  }

  void flow(Time duration) {
    for (const Time end = team_.now() + duration; team_.now() < end;) {
      sent_.push_back(team_.send(0, "robot_3", payload_));
      team_.run_for(interval_);
    }
  }

  /// Seconds from the silence of the relay in use to the next message at the destination. Nothing that the relay had
  /// still to send arrives after its end, so whatever arrives came another way.
  double kill_relay() {
    const Time killed = team_.now();
    const std::size_t before = team_.received(3).size();
    team_.kill(relay_);
    flow(400ms);
    team_.run_until_done([this] { return lost() == 0; }, 20s);
    if (team_.received(3).size() == before) return 1e9;
    return seconds(team_.received(3)[before].at - killed);
  }

  /// Messages not delivered, or not yet.
  int lost() const {
    return static_cast<int>(std::count_if(sent_.begin(), sent_.end(), [this](SendId id) {
      const SendFinished* finished = team_.finished(0, id);
      return finished == nullptr || !finished->delivered;
    }));
  }
  /// How many messages arrived twice, or altered.
  int spoiled() {
    const auto whole = std::count_if(team_.received(3).begin(), team_.received(3).end(),
                                     [this](const auto& received) { return received.packet.payload == payload_; });
    return static_cast<int>(team_.received(3).size() - static_cast<std::size_t>(whole)) +
           std::abs(static_cast<int>(whole) - static_cast<int>(sent_.size()) + lost());
  }

 private:
  Time interval_;  ///< between messages
  Team team_;
  Bytes payload_ = noise(kMessage, 3);
  std::size_t relay_ = 0;
  std::vector<SendId> sent_;
};

MediumOptions radio(double loss) {
  MediumOptions medium;
  medium.loss = loss;
  return medium;
}

}  // namespace

Row repair(const MediumOptions& medium, const std::string& on, Time interval, int first_seed, int kills) {
  std::vector<double> times;
  int lost = 0;
  int spoiled = 0;
  for (int seed = first_seed; seed < first_seed + kills; ++seed) {
    Square square(medium, interval, static_cast<std::uint64_t>(seed));
    square.flow(300ms + Time(seed % 100 * 1'000'000));
    times.push_back(square.kill_relay());
    lost += square.lost();
    spoiled += square.spoiled();
  }
  const double p99 = quantile(times, 0.99);
  return {format("repair after %.0f kills at half capacity, loss %.0f %%", kills, medium.loss * 100) + on + ": p99",
          "<= 1.0",
          p99,
          "s",
          p99 <= 1.0 && lost == 0 && spoiled == 0,
          format("p50 %.3f s, max %.3f s, messages lost: %.0f", quantile(times, 0.5), quantile(times, 1.0), lost) +
              format(", twice or altered: %.0f", spoiled)};
}

namespace {

/// The slowest of several.
Row absent(int seeds) {
  double slowest = 0;
  std::string reason;
  for (int seed = 1; seed <= seeds; ++seed) {
    Team team({}, static_cast<std::uint64_t>(seed));
    team.add_line(3);
    team.run_for(1s);
    const Time start = team.now();
    const SendId id = team.send(0, "robot_7", text("x"));
    team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 20s);
    slowest = std::max(slowest, seconds(team.now() - start));
    reason = team.finished(0, id) ? team.finished(0, id)->reason : "never";
  }
  return {"absent destination reported, slowest", "<= 2.0", slowest, "s", slowest <= 2.0, reason};
}

}  // namespace

Row first_route(const MediumOptions& medium, const std::string& on, int seeds) {
  std::vector<double> times;
  for (int seed = 1; seed <= seeds; ++seed) {
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
  const double bar = medium.loss > 0 ? 0.5 : 0.05;
  const double p50 = quantile(times, 0.5);
  return {format("first message over 4 hops, loss %.0f %%", medium.loss * 100) + on + ", p50",
          format("<= %.2f", bar),
          p50,
          "s",
          p50 <= bar,
          format("p99 %.3f s", quantile(times, 0.99))};
}

void measure_routes(const Effort& effort, Rows& rows) {
  const int trials = effort.trials;
  const Time half_of_capacity(static_cast<Time::rep>(8e9 * kMessage / (0.5 * capacity())));
  for (const double loss : {0.0, 0.1}) rows.add(repair(radio(loss), "", half_of_capacity, 1, kKillsPerTrial * trials));
  for (const double loss : {0.0, 0.3}) rows.add(first_route(radio(loss), "", trials));
  rows.add(absent(trials));
}

}  // namespace adhoc_communication::bench
