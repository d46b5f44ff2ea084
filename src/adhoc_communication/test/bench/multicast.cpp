// Packets from a root to all members of its group.
#include <algorithm>
#include <cmath>

#include "rows.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kSeeds = 10;
constexpr std::size_t kSymbolRoom = 1500 - wire::kHeaderSize - wire::kTagSize - wire::kGroupDataHeaderSize;

/// Symbols sent, by robot, and the air time of everything else that groups need.
struct Count {
  explicit Count(Team& team, std::size_t robots) : symbols(robots) {
    team.on_transmission = [this](std::size_t robot, const Frame& frame) {
      const auto type = static_cast<wire::FrameType>(frame.bytes[1]);
      const std::size_t empty = wire::kHeaderSize + wire::kGroupDataHeaderSize + wire::kTagSize;
      if (type == wire::FrameType::kGroupData && frame.bytes.size() > empty) {
        ++symbols[robot];
        data += air_time(frame);
      } else if (type != wire::FrameType::kBeacon) {
        feedback += air_time(frame);
      }
    };
  }
  static double air_time(const Frame& frame) { return 50e-6 + 8.0 * static_cast<double>(frame.bytes.size()) / 50e6; }

  std::vector<int> symbols;
  double data = 0;
  double feedback = 0;
};

struct Outcome {
  double sends_per_frame = 0;
  int complete = 0;
  double feedback = 0;  ///< share of the air time
  double time = 0;
};

/// `count` packets of `octets` to everybody; the robots stand as `place` says.
template <typename Place>
Outcome send_to_all(std::size_t robots, const Place& place, std::size_t octets, int packets, double loss,
                    std::uint64_t seed) {
  MediumOptions medium;
  medium.loss = loss;
  Team team(medium, seed);
  place(team);
  team.run_for(8s);
  Count count(team, robots);
  Outcome outcome;
  const Time begin = team.now();
  for (int i = 0; i < packets; ++i) {
    const Bytes payload = noise(octets, seed + static_cast<std::uint64_t>(i));
    const SendId id = team.send(0, "mc_robot_0", payload, Priority::kBulk);
    team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 60s);
    const bool delivered = team.finished(0, id) != nullptr && team.finished(0, id)->delivered;
    for (std::size_t robot = 1; robot < robots; ++robot) {
      const auto& received = team.received(robot);
      if (delivered && received.size() == static_cast<std::size_t>(i) + 1 &&
          received.back().packet.payload == payload) {
        ++outcome.complete;
      }
    }
  }
  outcome.time = seconds(team.now() - begin) / packets;
  double symbols = 0;
  for (const int sent : count.symbols) symbols += sent;
  outcome.sends_per_frame = symbols / packets / std::ceil(static_cast<double>(octets + 50) / kSymbolRoom);
  outcome.feedback = count.feedback / (count.data + count.feedback);
  return outcome;
}

/// The worst of the seeds has to reach the bar.
Row row_of(const std::string& what, double bar, const std::vector<Outcome>& outcomes, int members, int packets,
           double ideal) {
  std::vector<double> sends, feedback, times;
  int complete = 0;
  for (const Outcome& outcome : outcomes) {
    sends.push_back(outcome.sends_per_frame);
    feedback.push_back(100 * outcome.feedback);
    times.push_back(outcome.time);
    complete += outcome.complete;
  }
  const int expected = members * packets * static_cast<int>(outcomes.size());
  const double worst = quantile(sends, 1.0);
  return {
      what + ": worst",
      format("<= %.3f", bar),
      worst,
      "sends/frame",
      worst <= bar && complete == expected,
      format("median %.3f of %.0f seeds, ideal %.2f", quantile(sends, 0.5), static_cast<double>(sends.size()), ideal) +
          format("; complete %.0f of %.0f", complete, expected) +
          format("; feedback %.1f %% of the air, at most %.1f; %.3f s each", quantile(feedback, 0.5),
                 quantile(feedback, 1.0), quantile(times, 0.5))};
}

template <typename Place>
std::vector<Outcome> by_seed(std::size_t robots, const Place& place, std::size_t octets, int packets, double loss) {
  std::vector<Outcome> outcomes;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    outcomes.push_back(send_to_all(robots, place, octets, packets, loss, seed));
  }
  return outcomes;
}

Row one_hop(std::size_t octets, int packets, double loss, double bar, const std::string& what) {
  const auto star = [](Team& team) {
    for (int i = 0; i < 9; ++i) team.add();
  };
  const int frames = octets > kSymbolRoom ? 128 : 1;
  return row_of(what + format(" to 8 members in one hop, loss %.0f %%", 100 * loss), bar,
                by_seed(9, star, octets, packets, loss), 8, packets, ideal_sends(frames, 8, loss));
}

/// Two relays behind the root, three members behind each.
Row tree(double loss) {
  const auto place = [](Team& team) {
    team.add({}, 0, 0);
    for (const double side : {-1.0, 1.0}) {
      team.add({}, 8, side * 5);
      for (int leaf = -1; leaf <= 1; ++leaf) team.add({}, 15, side * 8 + leaf);
    }
  };
  const double ideal = loss > 0 ? ideal_sends(128, 2, loss) + 2 * ideal_sends(128, 3, loss) : 3;
  return row_of(format("1 MB over a tree of two relays with three members each, loss %.0f %%", 100 * loss), 1.2 * ideal,
                by_seed(9, place, 1'000'000, 1, loss), 8, 1, ideal);
}

Row line(double loss) {
  const auto place = [](Team& team) { team.add_line(6); };
  const double ideal = loss > 0 ? 5 * ideal_sends(128, 1, loss) : 5;
  return row_of(format("1 MB over a line of 5 hops, loss %.0f %%", 100 * loss), 1.2 * ideal,
                by_seed(6, place, 1'000'000, 1, loss), 5, 1, ideal);
}

}  // namespace

double ideal_sends(int frames, int children, double loss) {
  double expected = 0;
  for (int sent = 0; sent < 40 * frames + 400; ++sent) {
    double enough = 0;  // probability that one child has got `frames` of `sent`
    for (int got = frames; got <= sent; ++got) {
      enough += std::exp(std::lgamma(sent + 1.0) - std::lgamma(got + 1.0) - std::lgamma(sent - got + 1.0) +
                         got * std::log1p(-loss) + (sent - got) * std::log(loss));
    }
    const double missing = 1 - std::pow(std::min(1.0, enough), children);
    expected += missing;
    if (sent > frames && missing < 1e-6) break;
  }
  return expected / frames;
}

void measure_multicast(const Effort& effort, Rows& rows) {
  const int trials = effort.trials;
  rows.add(one_hop(1'000'000, 1, 0.1, 1.35, "1 MB"));
  rows.add(one_hop(1'000'000, 1, 0.3, 1.75, "1 MB"));
  rows.add(one_hop(1000, 2 * trials, 0.1, 1.9, "1 frame"));
  rows.add(one_hop(1000, 2 * trials, 0.3, 3.1, "1 frame"));
  for (const double loss : {0.0, 0.1, 0.3}) rows.add(tree(loss));
  for (const double loss : {0.1, 0.3}) rows.add(line(loss));
}

}  // namespace adhoc_communication::bench
