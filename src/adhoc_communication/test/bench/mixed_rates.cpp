// A packet for a group where, as on Wi-Fi, frames for everybody go at a base rate and those for one robot faster.
//
// A root in the middle, its members around it in one hop; carrier sense, retries of unicasts. The time is that from the
// request to the last member's word, over that of the data frames alone in the better of two ways, each with the mean
// wait for the channel and nothing else: one after another to each member, or for everybody as often as the best code
// needs.
#include <algorithm>
#include <cmath>

#include "rows.hpp"
#include "wifi.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kOctets = 1'000'000;
constexpr double kBar = 1.2;

struct Mix {
  std::vector<double> unicast;  ///< bit/s to each member
  double broadcast;             ///< bit/s
  double loss;                  ///< of each try
};

MediumOptions medium_of(const Mix& mix) { return wifi(mix.loss, mix.broadcast); }

constexpr std::size_t kFullGroupFrame = 1500;

/// Seconds.
double ideal(const Mix& mix) {
  const MediumOptions medium = medium_of(mix);
  const double room = 1500.0 - wire::kHeaderSize - wire::kTagSize - wire::kGroupDataHeaderSize;
  const double frames = std::ceil(kOctets / room);
  double unicasts = 0;
  for (const double bit_rate : mix.unicast)
    unicasts += frame_time(kFullGroupFrame, bit_rate, true, medium) / (1 - mix.loss);
  const int members = static_cast<int>(mix.unicast.size());
  const double sends = mix.loss > 0 ? ideal_sends(128, members, mix.loss) : 1.0;
  return frames * std::min(unicasts, sends * frame_time(kFullGroupFrame, mix.broadcast, false, medium));
}

struct Outcome {
  double time = 0;
  double air = 0;
  double unicasts = 0;  ///< share of the data frames
  bool complete = false;
};

Outcome send_to_group(const Mix& mix, std::uint64_t seed) {
  const MediumOptions medium = medium_of(mix);
  Team team(medium, seed);
  team.add({}, 0, 0);
  for (std::size_t i = 0; i < mix.unicast.size(); ++i) {
    const double angle = 2 * std::acos(-1.0) * static_cast<double>(i) / static_cast<double>(mix.unicast.size());
    const double distance = distance_at(mix.unicast[i], medium);
    team.add({}, distance * std::cos(angle), distance * std::sin(angle));
  }
  team.run_for(8s);
  int unicasts = 0;
  int broadcasts = 0;
  team.on_transmission = [&](std::size_t, const Frame& frame) {
    if (static_cast<wire::FrameType>(frame.bytes[1]) != wire::FrameType::kGroupData) return;
    ++(frame.destination == wire::kEverybody ? broadcasts : unicasts);
  };
  const Time air_before = team.medium().counters().air_time;
  const Time begin = team.now();
  const Bytes payload = noise(kOctets, seed);
  const SendId id = team.send(0, "mc_robot_0", payload, Priority::kBulk);
  team.run_until_done([&] { return team.finished(0, id) != nullptr; }, 120s);
  Outcome outcome;
  outcome.time = seconds(team.now() - begin);
  outcome.air = seconds(team.medium().counters().air_time - air_before);
  outcome.unicasts = static_cast<double>(unicasts) / std::max(1, unicasts + broadcasts);
  outcome.complete = team.finished(0, id) != nullptr && team.finished(0, id)->delivered;
  for (std::size_t robot = 1; robot <= mix.unicast.size(); ++robot) {
    const auto& received = team.received(robot);
    outcome.complete = outcome.complete && received.size() == 1 && received.back().packet.payload == payload;
  }
  return outcome;
}

Row row_of(const std::string& what, const Mix& mix, int seeds) {
  std::vector<double> ratios;
  double air = 0;
  double unicasts = 0;
  int complete = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Outcome outcome = send_to_group(mix, static_cast<std::uint64_t>(seed));
    ratios.push_back(outcome.time / ideal(mix));
    air += outcome.air / seeds;
    unicasts += outcome.unicasts / seeds;
    complete += outcome.complete;
  }
  const double worst = *std::max_element(ratios.begin(), ratios.end());
  return {"1 MB to the group at mixed rates, " + what + ": worst",
          format("<= %.2f", kBar),
          worst,
          "1",
          worst <= kBar && complete == seeds,
          format("median %.3f, ideal %.2f s, air %.2f s", quantile(ratios, 0.5), ideal(mix), air) +
              format(", %.0f %% unicasts, complete %.0f of %.0f seeds", 100 * unicasts, complete, seeds)};
}

std::string name_of(const Mix& mix, const std::string& members) {
  return members + format(", broadcast %.0f, loss %.0f %%", mix.broadcast * 1e-6, 100 * mix.loss);
}

}  // namespace

void measure_mixed_rates(const Effort& effort, Rows& rows) {
  const int seeds = std::max(10, effort.trials / 2);
  const auto all_at = [](std::size_t members, double bit_rate) { return std::vector<double>(members, bit_rate); };
  for (const double loss : {0.0, 0.1}) {
    for (const auto& [members, broadcast] : {std::pair(8, 6e6), {2, 6e6}, {4, 6e6}, {8, 1e6}, {2, 1e6}}) {
      const Mix mix{all_at(static_cast<std::size_t>(members), 54e6), broadcast, loss};
      rows.add(row_of(name_of(mix, format("%.0f members at 54", members)), mix, seeds));
    }
    const Mix near_and_far{{54e6, 54e6, 54e6, 6e6}, 6e6, loss};
    rows.add(row_of(name_of(near_and_far, "3 members at 54, 1 at 6"), near_and_far, seeds));
    const Mix alike{all_at(4, 6e6), 6e6, loss};
    rows.add(row_of(name_of(alike, "4 members at 6"), alike, seeds));
  }
}

}  // namespace adhoc_communication::bench
