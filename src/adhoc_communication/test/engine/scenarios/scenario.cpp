#include "scenario.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "random.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using Kind = Action::Kind;

constexpr double kSpacing = 8.0;  ///< metres between neighbours; the radio reaches 10
constexpr Time kFirstAction = 1s;
constexpr Time kMoveInterval = 200ms;
constexpr double kSpeed = 3.0;  ///< m/s, so that links come and go within seconds
constexpr Time kKeyStep = 400ms;

/// Draws the parts of one scenario.
class Generator {
 public:
  Generator(std::uint64_t seed, bool contended) : random_(seed), contended_(contended) { scenario_.seed = seed; }

  Scenario make() {
    draw_radio();
    draw_places();
    draw_options();
    scenario_.end = kFirstAction + between(10s, 25s);
    draw_mobility();
    draw_faults();
    draw_sends();
    draw_memberships();
    draw_keys();
    draw_contention();
    draw_packet_limit();
    std::stable_sort(scenario_.actions.begin(), scenario_.actions.end(),
                     [](const Action& a, const Action& b) { return a.at < b.at; });
    return std::move(scenario_);
  }

 private:
  std::size_t below(std::size_t bound) { return random_.next() % bound; }
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  Time between(Time low, Time high) { return low + random_.delay(high - low); }
  Time moment() { return between(kFirstAction, scenario_.end); }
  std::size_t robots() const { return scenario_.places.size(); }
  std::size_t any_robot() { return below(robots()); }
  std::size_t other_than(std::size_t robot) { return (robot + 1 + below(robots() - 1)) % robots(); }
  Priority any_priority() { return static_cast<Priority>(below(4)); }

  Action& add(Time at, Kind kind, std::size_t robot = 0, std::size_t other = 0) {
    Action action;
    action.at = at;
    action.kind = kind;
    action.robot = robot;
    action.other = other;
    scenario_.actions.push_back(std::move(action));
    return scenario_.actions.back();
  }

  /// Most packets are small, some have about 100 kB, some have nothing in them.
  std::size_t any_size() {
    if (random_.chance(0.1)) return 0;
    return static_cast<std::size_t>(std::pow(10.0, between(0.0, 5.0)));
  }

  void draw_radio() {
    MediumOptions& medium = scenario_.medium;
    medium.loss = std::array<double, 5>{0.0, 0.0, 0.05, 0.1, 0.3}[below(5)];
    medium.bit_rate = random_.chance(0.3) ? 6e6 : 50e6;
    medium.shared = random_.chance(0.3);
    if (random_.chance(0.3)) medium.duplication = 0.05;
    if (random_.chance(0.3)) medium.reordering = 0.05;
    if (random_.chance(0.3)) medium.corruption = 0.02;
  }

  void draw_places() {
    const std::size_t count = 5 + below(8);
    auto& places = scenario_.places;
    switch (below(4)) {
      case 0:
        scenario_.topology = "line";
        for (std::size_t i = 0; i < count; ++i) places.emplace_back(kSpacing * static_cast<double>(i), 0.0);
        return;
      case 1:
        scenario_.topology = "star";
        places.emplace_back(0.0, 0.0);
        for (std::size_t i = 1; i < count; ++i) {
          const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(count - 1);
          places.emplace_back(9 * std::cos(angle), 9 * std::sin(angle));
        }
        return;
      case 2:
        scenario_.topology = "grid";
        for (std::size_t i = 0; i < count; ++i) {
          places.emplace_back(kSpacing * static_cast<double>(i % 3), kSpacing * static_cast<double>(i / 3));
        }
        return;
      default:
        scenario_.topology = "scattered";
        const double side = 4.5 * std::sqrt(static_cast<double>(count) * 2);
        for (std::size_t i = 0; i < count; ++i) places.emplace_back(between(0.0, side), between(0.0, side));
    }
  }

  void draw_options() {
    EngineOptions& options = scenario_.options;
    if (random_.chance(0.5)) options.keys = {any_key()};
    if (random_.chance(0.1)) options.num_link_retrans = 0;
    if (random_.chance(0.2)) options.hop_limit_min = 1;
    if (random_.chance(0.2)) options.max_frame_size = 400;
    options.join_groups_automatically = random_.chance(0.7);
  }

  /// Late, so that all else is as without it; so is what follows.
  void draw_contention() {
    MediumOptions& medium = scenario_.medium;
    medium.contention = (medium.shared && random_.chance(0.5)) || contended_;
    medium.shared = medium.shared && !medium.contention;
  }

  /// Room for few packets at once, so that it runs out; some that are sent fill it, some are too large.
  void draw_packet_limit() {
    if (!random_.chance(0.3)) return;
    const double limit = std::pow(10.0, between(3.3, 5.0));
    scenario_.options.max_packet_size = static_cast<std::size_t>(limit);
    for (Action& action : scenario_.actions) {
      const bool acknowledged = action.kind == Kind::kUnicast || action.kind == Kind::kGroup;
      if (acknowledged && random_.chance(0.3)) action.size = static_cast<std::size_t>(limit * between(0.5, 1.1));
    }
  }

  TeamKey any_key() {
    TeamKey key;
    for (std::uint8_t& octet : key) octet = static_cast<std::uint8_t>(random_.next());
    return key;
  }

  void draw_mobility() {
    const double share = std::array<double, 3>{0.0, 0.3, 1.0}[below(3)];
    for (std::size_t robot = 0; robot < robots(); ++robot) {
      if (random_.chance(share)) draw_walk(robot);
    }
  }

  /// Random waypoints among the places of the team.
  void draw_walk(std::size_t robot) {
    auto [x, y] = scenario_.places[robot];
    auto [goal_x, goal_y] = scenario_.places[any_robot()];
    const double step = kSpeed * std::chrono::duration<double>(kMoveInterval).count();
    for (Time at = kFirstAction; at < scenario_.end; at += kMoveInterval) {
      const double distance = std::hypot(goal_x - x, goal_y - y);
      if (distance <= step) {
        std::tie(goal_x, goal_y) = scenario_.places[any_robot()];
        continue;
      }
      x += (goal_x - x) / distance * step;
      y += (goal_y - y) / distance * step;
      Action& move = add(at, Kind::kMove, robot);
      move.x = x;
      move.y = y;
    }
  }

  void draw_faults() {
    for (std::size_t left = below(4); left > 0; --left) {
      const std::size_t robot = any_robot();
      const Time at = moment();
      add(at, Kind::kCrash, robot);
      if (random_.chance(0.8)) add(at + between(Time(0), Time(8s)), Kind::kRestart, robot);
    }
    for (std::size_t left = below(6); left > 0; --left) {
      const std::size_t robot = any_robot();
      add(moment(), Kind::kOneWay, robot, other_than(robot)).x = random_.chance(0.5) ? 1.0 : between(0.3, 0.9);
    }
    if (random_.chance(0.3)) add(moment(), Kind::kLoss).x = between(0.0, 0.4);
    for (std::size_t left = below(3); left > 0; --left) {
      const Time at = moment();
      Action& partition = add(at, Kind::kPartition);
      for (std::size_t robot = 0; robot < robots(); ++robot) partition.side.push_back(random_.chance(0.5));
      add(at + between(Time(500ms), Time(8s)), Kind::kRejoin);
    }
  }

  void draw_sends() {
    for (std::size_t left = 10 + below(50); left > 0; --left) {
      const std::size_t robot = any_robot();
      Action& send = add(moment(), Kind::kUnicast, robot, other_than(robot));
      draw_packet(send);
      if (random_.chance(0.15)) draw_burst(send);
    }
    for (std::size_t left = below(12); left > 0; --left) {
      const std::size_t robot = any_robot();
      draw_packet(add(moment(), Kind::kGroup, robot, random_.chance(0.7) ? robot : other_than(robot)));
    }
    for (std::size_t left = below(6); left > 0; --left) {
      const Time at = moment();
      const std::size_t robot = any_robot();
      const std::size_t size = below(20'000);
      // Two at once: packets of different priorities interleave on the air.
      for (std::size_t copies = 1 + below(2); copies > 0; --copies) {
        Action& send = add(at, Kind::kBroadcast, robot);
        send.size = size;
        send.priority = any_priority();
      }
    }
    for (std::size_t left = below(6); left > 0; --left) {
      Action& send = add(moment(), Kind::kFlood, any_robot());
      send.size = below(200);
      send.hops = static_cast<std::uint8_t>(1 + below(5));
    }
  }

  void draw_packet(Action& send) {
    send.size = any_size();
    send.priority = any_priority();
  }

  /// More packets of the same kind at the same moment: their order shows.
  void draw_burst(const Action& first) {
    const Action copy = first;
    for (std::size_t left = 1 + below(8); left > 0; --left) {
      Action& send = add(copy.at, copy.kind, copy.robot, copy.other);
      send.priority = copy.priority;
      send.size = below(5000);
    }
  }

  void draw_memberships() {
    for (std::size_t left = below(10); left > 0; --left) {
      const std::size_t robot = any_robot();
      const Kind kind = random_.chance(0.6) ? Kind::kJoin : Kind::kLeave;
      add(moment(), kind, robot, other_than(robot));
    }
  }

  /// As `team_key` does it: each step reaches all robots before the next one begins.
  void draw_keys() {
    if (scenario_.options.keys.empty()) return;
    for (std::size_t left = below(5); left > 0; --left) add(moment(), Kind::kReplay);
    if (random_.chance(0.5)) return;
    const TeamKey former = scenario_.options.keys.front();
    const TeamKey next = any_key();
    const Time start = moment();
    const std::vector<std::vector<TeamKey>> steps = {{former, next}, {next, former}, {next}};
    for (std::size_t step = 0; step < steps.size(); ++step) {
      for (std::size_t robot = 0; robot < robots(); ++robot) {
        const Time begin = start + static_cast<int>(step) * kKeyStep;
        add(between(begin, begin + kKeyStep), Kind::kSetKeys, robot).keys = steps[step];
      }
    }
  }

  Random random_;
  bool contended_;
  Scenario scenario_;
};

}  // namespace

std::string describe(const Action& action) {
  const std::string robot = "robot_" + std::to_string(action.robot);
  const std::string other = "robot_" + std::to_string(action.other);
  const std::string packet =
      std::to_string(action.size) + " octets at priority " + std::to_string(static_cast<int>(action.priority));
  switch (action.kind) {
    case Kind::kMove:
      return robot + " moves to " + std::to_string(action.x) + ", " + std::to_string(action.y);
    case Kind::kLoss:
      return "loss of all links is " + std::to_string(action.x);
    case Kind::kOneWay:
      return "loss from " + robot + " to " + other + " is " + std::to_string(action.x);
    case Kind::kPartition: {
      std::string text = "the team is cut, on one side";
      for (std::size_t i = 0; i < action.side.size(); ++i) text += action.side[i] ? " " + std::to_string(i) : "";
      return text;
    }
    case Kind::kRejoin:
      return "all links are back";
    case Kind::kCrash:
      return robot + " crashes";
    case Kind::kRestart:
      return robot + " restarts";
    case Kind::kUnicast:
      return robot + " sends " + packet + " to " + other;
    case Kind::kGroup:
      return robot + " sends " + packet + " to mc_" + other;
    case Kind::kBroadcast:
      return robot + " broadcasts " + packet;
    case Kind::kFlood:
      return robot + " floods " + packet + " over " + std::to_string(action.hops) + " hops";
    case Kind::kJoin:
      return robot + " joins mc_" + other;
    case Kind::kLeave:
      return robot + " leaves mc_" + other;
    case Kind::kSetKeys:
      return robot + " gets " + std::to_string(action.keys.size()) + " keys";
    case Kind::kReplay:
      return "recorded frames are sent once more";
  }
  return {};
}

std::string describe(const Scenario& scenario) {
  const MediumOptions& medium = scenario.medium;
  std::ostringstream text;
  text << scenario.topology << " of " << scenario.places.size() << " robots, "
       << (medium.contention ? "a contended channel"
           : medium.shared   ? "one channel"
                             : "a channel each")
       << " of " << medium.bit_rate / 1e6 << " Mbit/s, loss " << medium.loss << ", duplication " << medium.duplication
       << ", reordering " << medium.reordering << ", corruption " << medium.corruption << "; "
       << (scenario.options.keys.empty() ? "open" : "sealed") << ", num_link_retrans "
       << scenario.options.num_link_retrans << ", hop_limit_min " << scenario.options.hop_limit_min
       << ", max_frame_size " << scenario.options.max_frame_size << ", max_packet_size "
       << scenario.options.max_packet_size
       << (scenario.options.join_groups_automatically ? "" : ", no automatic joins");
  return text.str();
}

Scenario make_scenario(std::uint64_t seed, bool contended) { return Generator(seed, contended).make(); }

}  // namespace adhoc_communication
