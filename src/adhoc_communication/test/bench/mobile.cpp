// Robots on the move, a hundred, or sixteen that tell all others: what arrives, what that costs, whether a seed repeats
// it.
#include <algorithm>
#include <ctime>
#include <deque>

#include "moving_team.hpp"
#include "rows.hpp"
#include "wire/frame_header.hpp"

namespace adhoc_communication::bench {
namespace {

using namespace std::chrono_literals;

constexpr double kSide = 100.0;      ///< m, of the square for a hundred robots
constexpr double kSideOfFew = 60.0;  ///< and for sixteen: as a large building
constexpr Time kInterval = 1s;       ///< between two packets of a robot to its partner, and of a root to its group
constexpr Time kNewPartners = 60s;   ///< each robot chooses another partner at random
constexpr Time kPathStands = 5s;     ///< a packet counts if a path stands for so long after it was sent
constexpr Time kWarmUp = 20s;        ///< to join the groups
constexpr std::size_t kUnicastOctets = 200;
constexpr std::size_t kGroupOctets = 1000;

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Tally {
  std::uint64_t sent = 0;
  std::uint64_t with_path = 0;  ///< one and the same path stood
  std::uint64_t arrived = 0;    ///< of these
  std::uint64_t delivered = 0;  ///< with a path or without

  double share() const { return with_path == 0 ? 0 : static_cast<double>(arrived) / static_cast<double>(with_path); }
};

/// Quiet: each robot has a channel of its own, and joins no group but that of its root. Crowded: all share one channel,
/// and everybody joins the groups of all.
enum class Air { kQuiet, kCrowded };

/// Of every `group_size` robots the first is the root of a group to which it sends, and the others are its members; of
/// groups of one, all other robots are.
struct Crew {
  std::string name;
  std::size_t robots;
  std::size_t group_size;
  double side;  ///< m
  Air air;
};

Crew hundred(Air air) {
  return {air == Air::kQuiet ? "100 robots on the move" : "100 robots on the move, contention and joins", 100, 10,
          kSide, air};
}
Crew sixteen() { return {"16 robots on the move that tell all others, contention", 16, 1, kSideOfFew, Air::kCrowded}; }

/// Sends and keeps the books: a packet to a group counts once for each member.
class Mission {
 public:
  Mission(const Crew& crew, std::uint64_t seed)
      : crew_(crew),
        moving_(crew.robots, crew.side, options(crew.air), seed, crew.air == Air::kCrowded),
        choice_(seed),
        partners_(crew.robots) {
    team().on_event = [this](std::size_t robot, const Event& event) { take(robot, event); };
  }

  /// Ends early, with what it has, once the program has taken `patience` seconds of processor time for it.
  void run(Time warm_up, Time duration, double patience) {
    give_up_at_ = processor_seconds() + patience;
    for (std::size_t robot = 0; robot < crew_.robots; ++robot) {
      choose_partner(robot);
      if (!is_root(robot)) team().engine(robot).join_group(group_of(robot), team().now());
    }
    const Time end = warm_up + duration;
    end_ = end + kPathStands;
    while (team().now() < end_ && !gave_up()) {
      if (team().now() >= warm_up && team().now() < end) send_due();
      moving_.step();
      judge();
    }
    reached_ = std::min(team().now(), end_);
    while (!waiting_.empty() && team().now() < end + 60s && !gave_up()) {
      moving_.step();
      forget_arrived();
    }
    for (const auto& [number, packet] : waiting_) count(packet);
  }

  Team& team() { return moving_.team(); }
  const MovingTeam& moving() const { return moving_; }
  const Tally& unicast() const { return tally_[0]; }
  const Tally& group() const { return tally_[1]; }
  bool complete() const { return reached_ == end_; }
  /// What is missing of the mission; nothing if it is complete.
  std::string shortfall() const {
    if (complete()) return "";
    return format("; not reached: stopped after %.1f of %.1f virtual seconds", seconds(reached_), seconds(end_));
  }

 private:
  struct Packet {
    std::size_t source;
    std::size_t destination;
    Time sent;
    bool to_group;
    bool judged = false;
    bool has_path = false;
    bool arrived = false;
  };
  using Number = std::pair<std::uint64_t, std::size_t>;  ///< of the packet, and who is to get it

  bool gave_up() const { return processor_seconds() >= give_up_at_; }

  static EngineOptions options(Air air) {
    EngineOptions options;
    options.join_groups_automatically = air == Air::kCrowded;
    return options;
  }

  bool is_root(std::size_t robot) const { return robot % crew_.group_size == 0; }
  std::string group_of(std::size_t robot) const {
    return "mc_" + Team::name(robot / crew_.group_size * crew_.group_size);
  }

  /// The robots take turns, so that a quarter of them sends in each step of 250 ms.
  void send_due() {
    const auto step = static_cast<std::size_t>(team().now() / MovingTeam::kStep);
    const std::size_t turns = kInterval / MovingTeam::kStep;
    const bool change = team().now() % kNewPartners < kInterval;
    for (std::size_t robot = step % turns; robot < crew_.robots; robot += turns) {
      if (change) choose_partner(robot);
      send_one(robot);
      if (is_root(robot)) send_to_group(robot);
    }
  }

  void choose_partner(std::size_t robot) {
    partners_[robot] = (robot + 1 + choice_.next() % (crew_.robots - 1)) % crew_.robots;
  }

  void send_one(std::size_t robot) {
    ++number_;
    waiting_[{number_, partners_[robot]}] = {robot, partners_[robot], team().now(), false};
    team().send(robot, Team::name(partners_[robot]), numbered(kUnicastOctets));
  }

  void send_to_group(std::size_t root) {
    ++number_;
    const std::size_t members = (crew_.group_size == 1 ? crew_.robots : crew_.group_size) - 1;
    for (std::size_t i = 1; i <= members; ++i) {
      const std::size_t member = (root + i) % crew_.robots;
      waiting_[{number_, member}] = {root, member, team().now(), true};
    }
    team().send(root, group_of(root), numbered(kGroupOctets));
  }

  Bytes numbered(std::size_t octets) const {
    Bytes payload = noise(octets, number_);
    for (std::size_t i = 0; i < 8; ++i) payload[i] = static_cast<std::uint8_t>(number_ >> 8 * i);
    return payload;
  }

  void take(std::size_t robot, const Event& event) {
    const auto* packet = std::get_if<PacketReceived>(&event);
    if (packet == nullptr || packet->payload.size() < 8) return;
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < 8; ++i) number |= std::uint64_t{packet->payload[i]} << 8 * i;
    const auto found = waiting_.find({number, robot});
    if (found != waiting_.end()) found->second.arrived = true;
  }

  /// Decides about the packets that were sent kPathStands ago. Events need not be kept beyond.
  void judge() {
    const Time sent = team().now() - kPathStands;
    const std::vector<std::size_t> part = moving_.parts_since(sent);
    for (auto& [number, packet] : waiting_) {
      if (packet.sent > sent) break;
      if (packet.judged) continue;
      packet.judged = true;
      packet.has_path = part[packet.source] == part[packet.destination];
    }
    forget_arrived();
  }

  void forget_arrived() {
    for (auto packet = waiting_.begin(); packet != waiting_.end();) {
      const bool is_done = packet->second.judged && (packet->second.arrived || !packet->second.has_path);
      if (is_done) count(packet->second);
      packet = is_done ? waiting_.erase(packet) : std::next(packet);
    }
    for (std::size_t robot = 0; robot < crew_.robots; ++robot) team().received(robot).clear();
  }

  void count(const Packet& packet) {
    Tally& tally = tally_[packet.to_group ? 1 : 0];
    ++tally.sent;
    if (packet.arrived) ++tally.delivered;
    if (!packet.has_path) return;
    ++tally.with_path;
    if (packet.arrived) ++tally.arrived;
  }

  Crew crew_;
  MovingTeam moving_;
  Random choice_;
  std::vector<std::size_t> partners_;
  std::map<Number, Packet> waiting_;
  std::uint64_t number_ = 0;
  Tally tally_[2];
  double give_up_at_ = 0;  ///< of processor_seconds()
  Time end_{0};
  Time reached_{0};
};

Row delivered(const Mission& mission, const Crew& crew, const std::string& what, const Tally& tally,
              const std::string& detail) {
  return {crew.name + ", a path stood for 5 s: " + what,
          ">= 99.9",
          100 * tally.share(),
          "%",
          mission.complete() && tally.share() >= 0.999,
          format("%.0f of %.0f, sent %.0f", static_cast<double>(tally.arrived), static_cast<double>(tally.with_path),
                 static_cast<double>(tally.sent)) +
              detail + mission.shortfall()};
}

/// What the frames of a mission were, as shares.
std::string kinds_of_frames(Team& team) {
  using wire::FrameType;
  const std::pair<const char*, std::vector<FrameType>> kinds[] = {
      {"beacons", {FrameType::kBeacon}},
      {"requests", {FrameType::kRouteRequest}},
      {"answers and errors", {FrameType::kRouteReply, FrameType::kRouteError, FrameType::kRouteReplyAcknowledgment}},
      {"data", {FrameType::kData}},
      {"acknowledgments", {FrameType::kHopAcknowledgment, FrameType::kTransportAcknowledgment}},
      {"group data", {FrameType::kGroupData}},
      {"reports", {FrameType::kGroupReport, FrameType::kGroupReceipts}},
      {"trees", {FrameType::kGroupActivation, FrameType::kGroupRefusal}}};
  Statistics::ByType sent{};
  double all = 0;
  for (std::size_t robot = 0; robot < team.size(); ++robot) {
    const Statistics statistics = team.engine(robot).statistics();
    for (std::size_t type = 0; type < sent.size(); ++type) sent[type] += statistics.frames_sent_by_type[type];
    all += static_cast<double>(statistics.frames_sent);
  }
  std::string text;
  for (const auto& [kind, types] : kinds) {
    double frames = 0;
    for (const FrameType type : types) frames += static_cast<double>(sent[static_cast<std::size_t>(type)]);
    text += format(text.empty() ? "%.0f %% " : ", %.0f %% ", 100 * frames / all) + kind;
  }
  return text;
}

Row repeats(const Effort& effort) {
  std::uint64_t hashes[3];
  for (int i = 0; i < 3; ++i) {
    Mission mission(hundred(Air::kQuiet), i < 2 ? 1 : 2);
    mission.run(2s, 3s, effort.patience);
    hashes[i] = mission.team().trace_hash();
  }
  const bool same = hashes[0] == hashes[1];
  return {"100 robots on the move: the same seed gives the same frames",
          "1",
          same ? 1.0 : 0.0,
          "1",
          same && hashes[0] != hashes[2],
          "two short runs; another seed gives others"};
}

void measure_mission(const Crew& crew, const Effort& effort, Rows& rows) {
  const double begin = wall_seconds();
  const double start = processor_seconds();
  Mission mission(crew, effort.seed);
  mission.run(kWarmUp, Time(static_cast<Time::rep>(effort.minutes * 60e9)), effort.patience);
  const double wall = wall_seconds() - begin;
  const double cpu = processor_seconds() - start;
  const double bar = 6 * effort.minutes;
  const auto frames = static_cast<double>(mission.team().medium().counters().frames);
  const auto heard = static_cast<double>(mission.team().medium().counters().delivered);
  const auto packets = static_cast<double>(mission.unicast().delivered + mission.group().delivered);
  const double per_packet = packets > 0 ? frames / packets : frames;
  const bool complete = mission.complete();
  rows.add(delivered(
      mission, crew, "unicast 200 B/s each", mission.unicast(),
      format("; %.1f good neighbours, %.2g frames, heard %.2g times", mission.moving().mean_degree(), frames, heard)));
  const std::string groups = crew.group_size == 1 ? "1 kB/s each to all others" : "10 groups of 10, 1 kB/s each";
  rows.add(delivered(mission, crew, groups, mission.group(), " (counted for each member)"));
  rows.add({crew.name + ": frames for each packet delivered", "<= 40", per_packet, "frames",
            complete && per_packet <= 40,
            format("%.3g frames, %.3g packets, path or not: ", frames, packets) + kinds_of_frames(mission.team()) +
                mission.shortfall()});
  rows.add({crew.name + ": hearings in a second of one core", ">= 200000", heard / cpu, "1/s", heard / cpu >= 200'000,
            format("%.3g hearings in %.1f s of processor time", heard, cpu)});
  rows.add({crew.name + format(": %.3g virtual minutes on one core", effort.minutes), format("<= %.3g", bar), wall, "s",
            complete && wall <= bar, format("processor time %.1f s", cpu) + mission.shortfall()});
}

}  // namespace

void measure_mobile(const Effort& effort, Rows& rows) {
  for (const Crew& crew : {sixteen(), hundred(Air::kQuiet), hundred(Air::kCrowded)})
    measure_mission(crew, effort, rows);
  rows.add(repeats(effort));
}

}  // namespace adhoc_communication::bench
