#include "scenario_run.hpp"

#include <algorithm>
#include <queue>
#include <string_view>

#include "delivery_invariants.hpp"
#include "event_trace.hpp"
#include "random.hpp"
#include "route_invariants.hpp"
#include "simulation/team.hpp"
#include "tree_invariants.hpp"

namespace adhoc_communication {
namespace {

using namespace std::chrono_literals;
using Kind = Action::Kind;

constexpr Time kRecovery = 12s;  ///< good radio before the team has to be whole again
constexpr std::size_t kMostRecorded = 200;
constexpr std::size_t kReplayed = 20;

struct Enough {};

class Run {
 public:
  Run(const Scenario& scenario, const RunOptions& options)
      : scenario_(scenario),
        options_(options),
        team_(scenario.medium, scenario.seed),
        routes_(scenario.places.size()),
        trees_(scenario.places.size()),
        deliveries_(scenario.places.size(), scenario.options.num_link_retrans > 0, scenario.options.max_packet_size),
        trace_(options.trace),
        random_(scenario.seed ^ 0x7265706c6179) {
    watch();
    for (const auto& [x, y] : scenario.places) {
      team_.add(scenario.options, x, y);
      booted(team_.size() - 1);
    }
    stranger_ = team_.medium().add_node("stranger", MacAddress{6, 6, 6, 6, 6, 6});
  }

  Outcome play() {
    Outcome outcome;
    try {
      for (const Action& action : scenario_.actions) {
        run_to(action.at);
        carry_out(action);
      }
      run_to(scenario_.end);
      drain();
      recover();
      check_recovered();
    } catch (const Violation& violation) {
      outcome.violation = violation.what();
      outcome.tail = trace_.tail();
    } catch (const std::logic_error& error) {
      outcome.violation = error.what();
      outcome.tail = trace_.tail();
    } catch (const Enough&) {
    }
    outcome.events = events_;
    outcome.sends = deliveries_.sends();
    outcome.deliveries = deliveries_.delivered();
    outcome.trace_hash = team_.trace_hash();
    outcome.room_taken = room_taken_;
    return outcome;
  }

 private:
  void watch() {
    team_.on_frame = [this](Medium::Node node, const Frame& frame) {
      if (node < team_.size()) trace_.heard(team_.now(), node, frame);
    };
    team_.on_transmission = [this](std::size_t robot, const Frame& frame) {
      trace_.sent(team_.now(), robot, frame);
      record(frame);
    };
    team_.on_event = [this](std::size_t robot, const Event& event) { take(robot, event); };
    team_.after_step = [this](std::size_t robot) { check(robot); };
  }

  void record(const Frame& frame) {
    if (scenario_.options.keys.empty()) return;
    if (recorded_.size() < kMostRecorded) {
      recorded_.push_back(frame);
    } else {
      recorded_[random_.next() % kMostRecorded] = frame;
    }
  }

  void take(std::size_t robot, const Event& event) {
    if (const auto* packet = std::get_if<PacketReceived>(&event)) {
      trace_.note(team_.now(), Team::name(robot) + " received " + packet->topic + " from " + packet->source);
      deliveries_.received(robot, *packet);
      team_.received(robot).clear();
    } else if (const auto* end = std::get_if<SendFinished>(&event)) {
      trace_.note(team_.now(), Team::name(robot) + " finished send " + std::to_string(end->id) + ": " +
                                   (end->delivered ? "delivered" : end->reason));
      deliveries_.finished(robot, *end, team_.now());
    } else if (const auto* appeared = std::get_if<RobotAppeared>(&event)) {
      trace_.note(team_.now(), Team::name(robot) + " knows " + appeared->robot);
    } else if (const auto* lost = std::get_if<RobotLost>(&event)) {
      trace_.note(team_.now(), Team::name(robot) + " lost " + lost->robot);
    } else if (const auto* change = std::get_if<GroupChangeFinished>(&event)) {
      const std::string what = change->joined ? " joined " : " left ";
      trace_.note(team_.now(),
                  Team::name(robot) + what + change->group + (change->succeeded ? "" : ": " + change->reason));
      if (change->joined && !change->succeeded) {
        left_.insert({robot, root_of(change->group)});
        deliveries_.left(robot, root_of(change->group));
      }
    }
  }

  /// Every promise that can be checked on the state of one robot after it did something.
  void check(std::size_t robot) {
    if (++events_ > options_.most_events) throw Enough{};
    Engine& engine = team_.engine(robot);
    routes_.changed(robot, engine.routes(), team_.now());
    trees_.changed(robot, engine.trees());
    if (deliveries_.awaits_group(robot)) deliveries_.members(robot, members_of(robot));
    for (const TableFill& table : engine.tables()) {
      if (std::string_view(table.table) == "octets put together") {
        room_taken_ = std::max(room_taken_, static_cast<double>(table.size) / static_cast<double>(table.most));
      }
      if (table.size <= table.most) continue;
      throw Violation("table '" + std::string(table.table) + "' of " + Team::name(robot) + " has " +
                      std::to_string(table.size) + " entries, at most " + std::to_string(table.most) + " are allowed");
    }
  }

  static std::size_t root_of(const std::string& group) { return std::stoul(group.substr(group.rfind('_') + 1)); }

  std::set<std::size_t> members_of(std::size_t root) {
    std::set<std::size_t> members;
    for (const std::string& name : team_.engine(root).group_state("mc_" + Team::name(root)).members) {
      members.insert(std::stoul(name.substr(name.find('_') + 1)));
    }
    return members;
  }

  void booted(std::size_t robot) {
    routes_.booted(robot, team_.boot_id(robot));
    trees_.booted(robot, team_.boot_id(robot));
    deliveries_.booted(robot);
  }

  void run_to(Time at) {
    while (team_.now() < at) {
      team_.run_for(std::min<Time>(at - team_.now(), 1s));
      deliveries_.check_patience(team_.now());
    }
  }

  void carry_out(const Action& action) {
    if (action.kind != Kind::kMove) trace_.note(team_.now(), "* " + describe(action));
    Medium& medium = team_.medium();
    switch (action.kind) {
      case Kind::kMove:
        return medium.set_position(action.robot, action.x, action.y);
      case Kind::kLoss:
        return medium.set_loss(action.x);
      case Kind::kOneWay:
        return medium.set_one_way_loss(action.robot, action.other, action.x);
      case Kind::kPartition:
        return cut(action.side);
      case Kind::kRejoin:
        return give_links_back();
      case Kind::kCrash:
        return crash(action.robot);
      case Kind::kRestart:
        return restart(action.robot);
      case Kind::kSetKeys:
        return team_.set_keys(action.robot, action.keys);
      case Kind::kReplay:
        return replay();
      default:
        if (team_.alive(action.robot)) ask(action);
    }
  }

  /// What only a running robot can be asked for.
  void ask(const Action& action) {
    Engine& engine = team_.engine(action.robot);
    const Time now = team_.now();
    switch (action.kind) {
      case Kind::kFlood: {
        const SendId id = engine.broadcast(deliveries_.flood(action, now), now);
        return deliveries_.accepted(id, {});
      }
      case Kind::kJoin:
        left_.erase({action.robot, action.other});
        return engine.join_group("mc_" + Team::name(action.other), now);
      case Kind::kLeave:
        left_.insert({action.robot, action.other});
        deliveries_.left(action.robot, action.other);
        return engine.leave_group("mc_" + Team::name(action.other), now);
      default:
        const SendId id = engine.send(deliveries_.request(action, now), now);
        return deliveries_.accepted(id, owed(action));
    }
  }

  /// The members of the group that is sent to, and its root.
  std::set<std::size_t> owed(const Action& action) {
    if (action.kind != Kind::kGroup || !team_.alive(action.other)) return {};
    std::set<std::size_t> members = members_of(action.other);
    members.insert(action.other);
    for (const auto& [robot, root] : left_) {
      if (root == action.other) members.erase(robot);  // the root may not have heard of it yet
    }
    return members;
  }

  void cut(const std::vector<bool>& side) {
    for (std::size_t a = 0; a < side.size(); ++a) {
      for (std::size_t b = a + 1; b < side.size(); ++b) {
        if (side[a] != side[b]) team_.medium().set_link_loss(a, b, 1.0);
      }
    }
  }

  void give_links_back() {
    for (std::size_t a = 0; a < team_.size(); ++a) {
      for (std::size_t b = a + 1; b < team_.size(); ++b) team_.medium().set_link_loss(a, b, std::nullopt);
    }
  }

  void crash(std::size_t robot) {
    if (!team_.alive(robot)) return;
    team_.kill(robot);
    routes_.crashed(robot);
    trees_.crashed(robot);
    left_.erase(left_.lower_bound({robot, 0}), left_.lower_bound({robot + 1, 0}));
    deliveries_.crashed(robot);
  }

  void restart(std::size_t robot) {
    crash(robot);
    team_.restart(robot);
    booted(robot);
  }

  void replay() {
    for (std::size_t i = 0; i < std::min(kReplayed, recorded_.size()); ++i) {
      team_.medium().transmit(stranger_, recorded_[random_.next() % recorded_.size()], team_.now());
    }
  }

  /// Nothing new happens until every send has ended.
  void drain() {
    while (deliveries_.open() > 0) run_to(team_.now() + 1s);
  }

  void recover() {
    trace_.note(team_.now(), "* the radio is good, all robots run");
    give_links_back();
    // Without repetition on each hop nothing is promised on a lossy radio.
    team_.medium().set_loss(scenario_.options.num_link_retrans == 0 ? 0.0 : std::min(scenario_.medium.loss, 0.1));
    for (std::size_t robot = 0; robot < team_.size(); ++robot) {
      team_.medium().set_position(robot, scenario_.places[robot].first, scenario_.places[robot].second);
      if (!team_.alive(robot)) restart(robot);
    }
    run_to(team_.now() + kRecovery);
  }

  /// A13.3: where a path exists, packets arrive.
  void check_recovered() {
    for (std::size_t robot = 0; robot < team_.size(); ++robot) {
      const std::vector<std::size_t> others = reachable(robot);
      if (others.empty()) continue;
      Action probe;
      probe.kind = Kind::kUnicast;
      probe.robot = robot;
      probe.other = others[random_.next() % others.size()];
      probe.size = 1000;
      trace_.note(team_.now(), "* " + describe(probe));
      ask(probe);
      deliveries_.latest_has_to_arrive();
    }
    drain();
  }

  std::vector<std::size_t> reachable(std::size_t from) {
    std::vector<bool> seen(team_.size());
    std::vector<std::size_t> found;
    std::queue<std::size_t> front;
    seen[from] = true;
    for (front.push(from); !front.empty(); front.pop()) {
      for (std::size_t next = 0; next < team_.size(); ++next) {
        if (seen[next] || !team_.medium().in_range(front.front(), next)) continue;
        seen[next] = true;
        found.push_back(next);
        front.push(next);
      }
    }
    return found;
  }

  const Scenario& scenario_;
  const RunOptions& options_;
  Team team_;
  RouteInvariants routes_;
  TreeInvariants trees_;
  DeliveryInvariants deliveries_;
  EventTrace trace_;
  Random random_;
  Medium::Node stranger_ = 0;
  std::vector<Frame> recorded_;
  std::set<std::pair<std::size_t, std::size_t>> left_;  ///< who left whose group
  std::uint64_t events_ = 0;
  double room_taken_ = 0.0;
};

}  // namespace

Outcome run(const Scenario& scenario, const RunOptions& options) { return Run(scenario, options).play(); }

}  // namespace adhoc_communication
