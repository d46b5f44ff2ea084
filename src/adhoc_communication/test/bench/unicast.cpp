// Packets from one robot to another.
#include <algorithm>
#include <cmath>

#include "any_radio.hpp"
#include "rows.hpp"
#include "wire/frame_header.hpp"
#include "wire/messages.hpp"

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

/// Who sends when: each on a channel of its own; one at a time; in turns that those far apart share; or all on one
/// channel where those who do not hear each other send at once, and collide.
enum class Channel { kOwn, kShared, kReused, kContended };

/// Share of the capacity.
double share(std::size_t hops, double loss, Channel channel, std::uint64_t seed) {
  MediumOptions medium;
  medium.loss = loss;
  medium.shared = channel == Channel::kShared || channel == Channel::kReused;
  medium.spatial_reuse = channel == Channel::kReused;
  medium.contention = channel == Channel::kContended;
  return goodput(hops, 8.0, medium, seed) / capacity();
}

/// What one shared hop leaves to data when every eighth frame is acknowledged by a frame on the same channel.
double left_by_acknowledgments() {
  const MediumOptions medium;
  const double octets = static_cast<double>(acknowledgment_octets());
  const double acknowledgment = 8.0 * octets / medium.bit_rate + seconds(medium.frame_overhead);
  const double frame = 1500.0 * 8 / capacity();
  return frame / (frame + acknowledgment / 8);
}

/// The channel that each hop has for itself at best: where one node sends at a time, each hop takes its part of the
/// air; where those far apart send at once, three hops do.
double share_of(std::size_t hops, Channel channel) {
  if (channel == Channel::kOwn) return 1.0;
  return 1.0 / static_cast<double>(channel == Channel::kShared ? hops : std::min<std::size_t>(hops, 3));
}

double bar_of(std::size_t hops, double loss, Channel channel) {
  if (hops == 1) return 0.90 * (1 - loss) * (channel == Channel::kShared ? left_by_acknowledgments() : 1.0);
  return 0.85 * (1 - loss) * share_of(hops, channel);
}

std::string name_of(Channel channel) {
  if (channel == Channel::kOwn) return "";
  if (channel == Channel::kShared) return ", shared channel";
  return channel == Channel::kReused ? ", shared channel with spatial reuse" : ", contended channel";
}

/// The worst of some seeds has to reach the bar.
Row goodput_row(std::size_t hops, double loss, Channel channel, const std::vector<double>& shares) {
  const double bar = bar_of(hops, loss, channel);
  const double worst = quantile(shares, 0.0);
  return {format("goodput over capacity, %.0f hops, loss %.0f %%", static_cast<double>(hops), loss * 100) +
              name_of(channel) + ": worst",
          format(">= %.3f", bar),
          worst,
          "1",
          worst >= bar,
          format("median %.3f of %.0f seeds, %.2f Mbit/s", quantile(shares, 0.5), static_cast<double>(shares.size()),
                 quantile(shares, 0.5) * capacity() * 1e-6)};
}

std::vector<double> goodputs(std::size_t hops, double loss, Channel channel, int seeds) {
  std::vector<double> shares;
  for (int seed = 1; seed <= seeds; ++seed) {
    shares.push_back(share(hops, loss, channel, static_cast<std::uint64_t>(seed)));
  }
  return shares;
}

/// Between two hops and the most, of the medians.
Row fall_row(double loss, double first, double last) {
  const double fall = 100 * (1 - last / first);
  return {format("goodput falls from 2 to 10 hops, loss %.0f %%", loss * 100),
          "< 3",
          fall,
          "%",
          fall < 3,
          format("medians %.3f and %.3f", first, last)};
}

/// The slowest of the six, in the worst of the seeds; all packets intact. On a contended channel everybody hears
/// everybody.
Row six_to_one_base(Channel channel, int seeds) {
  std::vector<double> times;
  int intact = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    MediumOptions medium;
    medium.loss = 0.1;
    medium.contention = channel == Channel::kContended;
    EngineOptions options;
    options.max_packet_size = 1'010'000;
    Team team(medium, static_cast<std::uint64_t>(seed));
    for (int robot = 0; robot < 7; ++robot) team.add(options);
    team.run_for(1s);
    const Time start = team.now();
    std::vector<SendId> ids;
    for (std::size_t robot = 1; robot <= 6; ++robot) {
      ids.push_back(team.send(robot, "robot_0", noise(1'000'000, robot), Priority::kBulk));
    }
    const auto over = [&](std::size_t robot) { return team.finished(robot, ids[robot - 1]) != nullptr; };
    team.run_until_done([&] { return over(1) && over(2) && over(3) && over(4) && over(5) && over(6); }, 120s);
    times.push_back(seconds(team.now() - start));
    for (const Team::Received& received : team.received(0)) {
      const auto robot = static_cast<std::uint64_t>(received.packet.source.back() - '0');
      intact += received.packet.payload == noise(1'000'000, robot);
    }
  }
  return {"six robots send 1 MB each to one base at once, loss 10 %" + name_of(channel) + ": intact",
          std::to_string(6 * seeds) + " of " + std::to_string(6 * seeds),
          static_cast<double>(intact),
          "packets",
          intact == 6 * seeds,
          format("all six in %.2f s (median), %.2f s (worst of %.0f seeds)", quantile(times, 0.5), quantile(times, 1.0),
                 seeds)};
}

}  // namespace

std::size_t acknowledgment_octets() {
  return wire::kHeaderSize + wire::to_bytes(wire::HopAcknowledgment{}).size() + wire::kChecksumSize;
}

double goodput(std::size_t hops, double spacing, const MediumOptions& medium, std::uint64_t seed) {
  constexpr std::size_t kMegabytes = 20;
  Team team(medium, seed);
  team.add_line(hops + 1, {}, spacing);
  team.run_for(1s);
  const auto send = [&](std::size_t number) {
    return team.send(0, Team::name(hops), noise(1'000'000, number), Priority::kBulk);
  };
  const SendId first = send(kMegabytes);
  team.run_until_done([&] { return team.finished(0, first) != nullptr; }, 60s);
  const Time start = team.now();
  std::vector<SendId> ids;
  for (std::size_t number = 0; number < kMegabytes; ++number) ids.push_back(send(number));
  team.run_until_done([&] { return team.finished(0, ids.back()) != nullptr; }, 300s);
  const bool whole = std::all_of(ids.begin(), ids.end(), [&](SendId id) {
    return team.finished(0, id) != nullptr && team.finished(0, id)->delivered;
  });
  return whole ? 8e6 * kMegabytes / seconds(team.now() - start) : 0.0;
}

void measure_intact(const Effort& effort, Rows& rows) {
  for (const std::size_t hops : {1, 3, 10}) {
    for (const double loss : {0.0, 0.1, 0.3}) rows.add(transfer(hops, loss, effort.trials));
  }
}

void measure_base(const Effort& effort, Rows& rows) {
  for (const Channel channel : {Channel::kOwn, Channel::kContended}) {
    rows.add(six_to_one_base(channel, std::max(10, effort.trials / 2)));
  }
}

void measure_goodput(const Effort& effort, Rows& rows) {
  const int seeds = std::max(10, effort.trials / 2);
  for (const double loss : {0.0, 0.1, 0.3}) {
    double of_two_hops = 0;
    for (const std::size_t hops : {1, 2, 3, 10}) {
      const std::vector<double> shares = goodputs(hops, loss, Channel::kOwn, seeds);
      rows.add(goodput_row(hops, loss, Channel::kOwn, shares));
      if (hops == 2) of_two_hops = quantile(shares, 0.5);
      if (hops == 10) rows.add(fall_row(loss, of_two_hops, quantile(shares, 0.5)));
    }
    for (const std::size_t hops : {1, 2, 3, 10}) {
      rows.add(goodput_row(hops, loss, Channel::kShared, goodputs(hops, loss, Channel::kShared, seeds)));
    }
    for (const Channel channel : {Channel::kReused, Channel::kContended}) {
      rows.add(goodput_row(10, loss, channel, goodputs(10, loss, channel, seeds)));
    }
  }
}

}  // namespace adhoc_communication::bench
