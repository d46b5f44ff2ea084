// What the engine makes of channels that lose, delay and fade in other ways than by chance for each frame.
#include <algorithm>
#include <string>
#include <utility>

#include "channel_models.hpp"
#include "diamond.hpp"
#include "rows.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kMegabyte = 1'000'000;
constexpr int kPackets = 5;
constexpr Time kBegin = 4s;

/// Robots on a channel, and how often one of them has taken a link for lost.
class Run {
 public:
  Run(const ChannelModel& channel, std::uint64_t seed) : team_(channel.medium, seed), course_(channel.course()) {
    team_.after_step = [this](std::size_t robot) { watch(robot); };
  }

  Team& team() { return team_; }
  /// Watches the links between these two.
  void watch_link(std::size_t a, std::size_t b) {
    for (const auto& [robot, other] : {std::pair(a, b), std::pair(b, a)}) watched_.push_back({robot, other, false});
  }
  bool run_until_done(const std::function<bool()>& done, Time patience) {
    for (const Time end = team_.now() + patience; team_.now() < end;) {
      course_(team_.medium(), team_.now());
      const Time next = (team_.now() / kCourseStep + 1) * kCourseStep;
      if (team_.run_until_done(done, std::min(end, next) - team_.now())) return true;
    }
    return done();
  }
  void run_for(Time duration) {
    run_until_done([] { return false; }, duration);
  }
  int links_lost() const { return links_lost_; }

 private:
  struct Watched {
    std::size_t robot;
    std::size_t other;
    bool works;
  };
  void watch(std::size_t robot) {
    for (Watched& watched : watched_) {
      if (watched.robot != robot) continue;
      bool works = false;
      for (const LinkState& link : team_.engine(robot).links()) {
        if (link.address == Team::address(watched.other)) works = link.two_way;
      }
      if (std::exchange(watched.works, works) && !works) ++links_lost_;
    }
  }

  Team team_;
  Course course_;
  std::vector<Watched> watched_;
  int links_lost_ = 0;
};

struct Outcome {
  std::vector<double> shares;  ///< of the ideal
  std::vector<double> times;
  int delivered = 0;
  int spoiled = 0;  ///< arrived twice, or altered
  int whole = 0;
  int links_lost = 0;
  std::string reason;
};

/// Five packets of 1 MB, one behind the other.
void transfer(const ChannelModel& channel, Run& run, std::size_t from, std::size_t to, double ideal, std::uint64_t seed,
              Outcome& outcome) {
  Team& team = run.team();
  run.run_for(kBegin - team.now());
  std::vector<SendId> ids;
  for (std::uint64_t number = 0; number < kPackets; ++number) {
    ids.push_back(team.send(from, Team::name(to), noise(kMegabyte, seed * kPackets + number), Priority::kBulk));
  }
  const auto over = [&](SendId id) { return team.finished(from, id) != nullptr; };
  run.run_until_done([&] { return std::all_of(ids.begin(), ids.end(), over); },
                     60s + 30 * Time(static_cast<Time::rep>(1e9 * ideal)));
  const double time = seconds(team.now() - kBegin);
  run.run_for(1s + 4 * channel.medium.delay.fixed);
  int delivered = 0;
  for (std::uint64_t number = 0; number < kPackets; ++number) {
    const SendFinished* finished = team.finished(from, ids[number]);
    if (finished == nullptr) outcome.reason = "never ended";
    if (finished != nullptr && !finished->delivered) outcome.reason = finished->reason;
    const auto copies = std::count_if(team.received(to).begin(), team.received(to).end(), [&](const auto& received) {
      return received.packet.payload == noise(kMegabyte, seed * kPackets + number);
    });
    delivered += finished != nullptr && finished->delivered && copies == 1;
    outcome.spoiled += copies > 1;
    outcome.whole += static_cast<int>(copies);
  }
  outcome.spoiled += static_cast<int>(team.received(to).size()) - std::exchange(outcome.whole, 0);
  outcome.delivered += delivered;
  outcome.shares.push_back(delivered == kPackets ? ideal / time : 0.0);
  outcome.times.push_back(time);
  outcome.links_lost += run.links_lost();
}

/// The worst of the seeds has to reach the bar.
Row row_of(const std::string& what, double bar, const Outcome& outcome, int seeds) {
  const double worst = quantile(outcome.shares, 0.0);
  const int expected = kPackets * seeds;
  std::string detail =
      format("median %.3f, %.2f s; delivered %.0f", quantile(outcome.shares, 0.5), quantile(outcome.times, 0.5),
             outcome.delivered) +
      format(" of %.0f, twice or altered: %.0f, links lost: %.0f", expected, outcome.spoiled, outcome.links_lost);
  if (!outcome.reason.empty()) detail += "; " + outcome.reason;
  const bool holds = outcome.delivered == expected && outcome.spoiled == 0 && worst >= bar;
  return {what + ": worst", format(">= %.2f", bar), worst, "of the ideal", holds, detail};
}

Row goodput_row(const ChannelModel& channel, std::size_t hops, std::uint64_t first_seed, int seeds) {
  Outcome outcome;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Run run(channel, seed);
    run.team().add_line(hops + 1, channel.engine);
    for (std::size_t robot = 0; robot < hops; ++robot) run.watch_link(robot, robot + 1);
    transfer(channel, run, 0, hops, ideal_time(channel, hops, kPackets * kMegabyte, seed, kBegin), seed, outcome);
  }
  return row_of("5 MB, " + channel.name + format(", %.0f hops", static_cast<double>(hops)), 0.5, outcome, seeds);
}

Row first_route_row(const ChannelModel& channel, std::uint64_t first_seed, int seeds) {
  constexpr std::size_t kHops = 3;
  std::vector<double> times;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Run run(channel, seed);
    EngineOptions cold = channel.engine;
    cold.join_groups_automatically = false;  // joining would find the route before
    run.team().add_line(kHops + 1, cold);
    run.run_for(kBegin);
    run.team().send(0, Team::name(kHops), text("x"));
    const bool arrived = run.run_until_done([&] { return !run.team().received(kHops).empty(); }, 60s);
    times.push_back(arrived ? seconds(run.team().now() - kBegin) : 1e9);
  }
  const Time journey = channel.medium.delay.fixed + channel.medium.delay.jitter;
  const double bar =
      seconds(1s + channel.outage + 2 * channel.medium.bursts.bad + 3 * static_cast<int>(kHops) * journey);
  const double worst = quantile(times, 1.0);
  return {"first message over 3 hops, " + channel.name + ": slowest",
          format("<= %.2f", bar),
          worst,
          "s",
          worst <= bar,
          format("p50 %.3f s", quantile(times, 0.5))};
}

/// 64 kB to four members in one hop.
Row group_row(const ChannelModel& channel, std::uint64_t first_seed, int seeds) {
  constexpr std::size_t kMembers = 4;
  std::vector<double> times;
  int complete = 0;
  int spoiled = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Run run(channel, seed);
    for (std::size_t robot = 0; robot <= kMembers; ++robot) run.team().add(channel.engine);
    run.run_for(8s);
    const Bytes payload = noise(64'000, seed);
    const SendId id = run.team().send(0, "mc_robot_0", payload, Priority::kBulk);
    run.run_until_done([&] { return run.team().finished(0, id) != nullptr; }, 120s);
    times.push_back(seconds(run.team().now() - 8s));
    run.run_for(1s);
    for (std::size_t member = 1; member <= kMembers; ++member) {
      const auto& received = run.team().received(member);
      const bool whole = received.size() == 1 && received[0].packet.payload == payload;
      complete += whole;
      spoiled += !whole && !received.empty();
    }
  }
  const int expected = static_cast<int>(kMembers) * seeds;
  return {"64 kB to a group of 4, " + channel.name + ": complete",
          format("%.0f of %.0f", expected, expected),
          static_cast<double>(complete),
          "packets",
          complete == expected && spoiled == 0,
          format("time p50 %.3f s, max %.3f s; twice or altered: %.0f", quantile(times, 0.5), quantile(times, 1.0),
                 spoiled)};
}

/// Messages flow over three hops while the first link fades again and again.
Row recovery_row(const ChannelModel& channel, std::uint64_t first_seed, int seeds) {
  std::vector<double> times;
  int sent = 0;
  int arrived = 0;
  int lost = 0;
  int fades = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Run run(channel, seed);
    run.team().add_line(4, channel.engine);
    run.run_for(kBegin + Time(seed % 100 * 1'000'000));
    bool was_faded = false;
    std::vector<SendId> ids;
    std::vector<Time> ends;
    const auto send_for = [&](Time duration, bool sending) {
      for (const Time end = run.team().now() + duration; run.team().now() < end;) {
        if (sending) ids.push_back(run.team().send(0, "robot_3", noise(1000, ids.size())));
        const Time next = run.team().now() + 20ms;
        while (run.team().now() < next) {
          run.run_for(kCourseStep);
          const bool now_faded = faded(channel.outage, run.team().now());
          if (was_faded && !now_faded) ends.push_back(run.team().now());
          was_faded = now_faded;
        }
      }
    };
    send_for(3 * kFadePeriod, true);
    send_for(5s, false);
    sent += static_cast<int>(ids.size());
    const auto& received = run.team().received(3);
    arrived += static_cast<int>(received.size());
    for (const SendId id : ids) {
      const SendFinished* finished = run.team().finished(0, id);
      lost += finished == nullptr || !finished->delivered;
    }
    for (const Time end : ends) {
      const auto next =
          std::find_if(received.begin(), received.end(), [&](const auto& item) { return item.at >= end; });
      if (end - kBegin > 3 * kFadePeriod) continue;
      ++fades;
      times.push_back(next == received.end() ? 1e9 : seconds(next->at - end));
    }
  }
  const double worst = quantile(times, 1.0);
  return {"first message after " + channel.name + " of the first of 3 links: slowest",
          "<= 1.00",
          worst,
          "s",
          worst <= 1.0 && lost == 0 && arrived == sent,
          format("p50 %.3f s of %.0f fades; ", quantile(times, 0.5), fades) +
              format("messages sent %.0f, arrived %.0f, failed %.0f", sent, arrived, lost)};
}

/// A square, 0 - 1 - 3 and 0 - 2 - 3: the second link of the way in use fades for 2 s while the other way is there.
Row detour_row(std::uint64_t first_seed, int seeds) {
  std::vector<double> times;
  int lost = 0;
  int spoiled = 0;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Diamond diamond({}, seed);
    Team& team = diamond.team;
    const std::size_t& relay = diamond.relay;
    team.run_for(1s);
    std::vector<SendId> ids;
    const auto flow = [&](Time duration) {
      for (const Time end = team.now() + duration; team.now() < end; team.run_for(5ms)) {
        ids.push_back(team.send(0, "robot_3", noise(10'000, ids.size())));
      }
    };
    flow(300ms + Time(seed % 100 * 1'000'000));
    for (const bool first_link : {false, true}) {
      const std::size_t faded = first_link ? 0 : 3;
      const std::size_t used = relay;
      const Time begin = team.now();
      const std::size_t before = team.received(3).size();
      team.medium().set_link_loss(used, faded, 1.0);
      flow(2s);
      const auto& received = team.received(3);
      times.push_back(received.size() > before + 1 ? seconds(received[before + 1].at - begin) : 1e9);
      team.medium().set_link_loss(used, faded, std::nullopt);
      flow(1s);
    }
    team.run_for(10s);
    for (const SendId id : ids) {
      const SendFinished* finished = team.finished(0, id);
      lost += finished == nullptr || !finished->delivered;
    }
    spoiled += static_cast<int>(team.received(3).size()) != static_cast<int>(ids.size());
  }
  const double worst = quantile(times, 1.0);
  return {"message by another way when a link fades for 2 s: slowest",
          "<= 1.00",
          worst,
          "s",
          worst <= 1.0 && lost == 0 && spoiled == 0,
          format("p50 %.3f s, messages lost: %.0f, runs with some twice: %.0f", quantile(times, 0.5), lost, spoiled)};
}

/// Robots 0 and 2 are in range of 1; the direct link between them works one way only.
Row one_way_row(bool from_source, std::uint64_t first_seed, int seeds) {
  ChannelModel channel{from_source ? "source heard by the destination only" : "destination heard by the source only",
                       {}};
  Outcome outcome;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Run run(channel, seed);
    run.team().add_line(3, channel.engine);
    run.team().medium().set_one_way_loss(from_source ? 0 : 2, from_source ? 2 : 0, 0.0);
    run.watch_link(0, 1);
    run.watch_link(1, 2);
    transfer(channel, run, 0, 2, ideal_time(channel, 2, kPackets * kMegabyte, seed, kBegin), seed, outcome);
  }
  return row_of("5 MB over 2 hops beside a one-way link, " + channel.name, 0.5, outcome, seeds);
}

/// Two cliques of four; robot 4 is heard by all of both for 3 s, and by nobody for the next 3 s.
Row ferry_row(std::uint64_t first_seed, int seeds) {
  ChannelModel channel{"two cliques", {}};
  const auto is_here = [](Time now) { return now % 6s < 3s; };
  channel.course = [is_here]() -> Course {
    return [is_here, here = true](Medium& medium, Time now) mutable {
      if (std::exchange(here, is_here(now)) == is_here(now)) return;
      const Medium::Node bridge = medium.node_count() / 2;
      medium.set_position(bridge, is_here(now) ? 8 : 1000, 0);
    };
  };
  Outcome outcome;
  for (std::uint64_t seed = first_seed; seed < first_seed + static_cast<std::uint64_t>(seeds); ++seed) {
    Run run(channel, seed);
    for (std::size_t robot = 0; robot < 9; ++robot) {
      const double x = robot < 4 ? 0 : robot == 4 ? 8 : 16;
      run.team().add({}, x, static_cast<double>(robot % 5) * 0.2);
    }
    run.watch_link(0, 4);
    run.watch_link(4, 8);
    transfer(channel, run, 0, 8, ideal_time(channel, 2, kPackets * kMegabyte, seed, kBegin), seed, outcome);
  }
  return row_of("5 MB from clique to clique over one robot that comes and goes every 3 s", 0.5, outcome, seeds);
}

}  // namespace

void measure_channels(const Effort& effort, Rows& rows) {
  const int seeds = std::max(1, effort.trials / 2);
  for (const ChannelModel& channel : channel_models()) {
    for (const std::size_t hops : {1, 3}) rows.add(goodput_row(channel, hops, effort.seed, seeds));
    rows.add(first_route_row(channel, effort.seed, seeds));
    if (channel.outage > Time(0)) rows.add(recovery_row(channel, effort.seed, seeds));
    rows.add(group_row(channel, effort.seed, seeds));
  }
  rows.add(detour_row(effort.seed, seeds));
  for (const bool from_source : {true, false}) rows.add(one_way_row(from_source, effort.seed, seeds));
  rows.add(ferry_row(effort.seed, seeds));
}

}  // namespace adhoc_communication::bench
