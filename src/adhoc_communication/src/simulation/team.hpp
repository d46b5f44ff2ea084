// Robots in one process: engines on a simulated radio, driven by virtual time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adhoc_communication/engine.hpp"
#include "medium/medium.hpp"

namespace adhoc_communication {

class Team {
 public:
  explicit Team(const MediumOptions& medium = {}, std::uint64_t seed = 1) : medium_(medium, seed), seed_(seed) {}

  /// Adds a robot, robot_<i> if the options name none; returns i.
  std::size_t add(EngineOptions options = {}, std::optional<double> x = std::nullopt, double y = 0.0);
  /// `count` robots in a row, each in range of the next only.
  void add_line(std::size_t count, const EngineOptions& options = {}, double spacing = 8.0);

  /// The robot falls silent and forgets everything; restart() brings it back with a new boot id.
  void kill(std::size_t robot);
  void restart(std::size_t robot);

  /// New keys for a robot, also for its later runs.
  void set_keys(std::size_t robot, const std::vector<TeamKey>& keys);

  /// To be fetched anew in each callback.
  Engine& engine(std::size_t robot) {
    set_deadline(robot, Time::min());
    return *robots_.at(robot).engine;
  }
  std::size_t size() const { return robots_.size(); }
  bool alive(std::size_t robot) const { return robots_.at(robot).engine != nullptr; }
  /// How often the robot was started, and the identity of its latest run.
  int boots(std::size_t robot) const { return robots_.at(robot).boots; }
  const BootId& boot_id(std::size_t robot) const { return robots_.at(robot).boot_id; }
  Medium& medium() { return medium_; }
  Time now() const { return now_; }
  static MacAddress address(std::size_t robot);
  static std::string name(std::size_t robot) { return "robot_" + std::to_string(robot); }
  void set_position(std::size_t robot, double x, double y) { medium_.set_position(robots_.at(robot).node, x, y); }

  void run_for(Time duration) {
    run_until(now_ + duration, [] { return false; });
  }
  /// Runs until `done` or for at most `patience`; tells whether `done` was reached.
  bool run_until_done(const std::function<bool()>& done, Time patience) { return run_until(now_ + patience, done); }

  SendId send(std::size_t robot, const std::string& destination, Bytes payload, Priority priority = Priority::kNormal,
              const std::string& topic = "topic");

  SendId send(std::size_t robot, SendRequest request);
  SendId broadcast(std::size_t robot, BroadcastRequest request);

  struct Received {
    PacketReceived packet;
    Time at;
  };
  /// Off: what robots receive and are told is reported by on_event only, as in missions of hours.
  bool remembers = true;
  /// What each robot has received and been told, restarts included.
  std::vector<Received>& received(std::size_t robot) { return robots_.at(robot).received; }
  std::vector<std::pair<Time, std::string>>& presence(std::size_t robot) { return robots_.at(robot).presence; }
  std::vector<GroupChangeFinished>& group_changes(std::size_t robot) { return robots_.at(robot).group_changes; }
  const SendFinished* finished(std::size_t robot, SendId id) const;
  Time finished_at(std::size_t robot, SendId id) const { return robots_.at(robot).finished.at(id).second; }
  /// Takes part in the radio without an engine: sees the frames for `node` instead of a robot.
  std::function<void(Medium::Node, const Frame&)> on_frame;
  /// Called for every frame that a robot puts on the air.
  std::function<void(std::size_t, const Frame&)> on_transmission;
  /// Called for every event that a robot reports.
  std::function<void(std::size_t, const Event&)> on_event;
  /// Called whenever an engine has taken a frame, or was polled.
  std::function<void(std::size_t)> after_step;
  std::uint64_t polls() const { return polls_; }
  /// Changes with every frame on the air and its time.
  std::uint64_t trace_hash() const { return trace_hash_; }

 private:
  struct Robot {
    EngineOptions options;
    Medium::Node node;
    std::unique_ptr<Engine> engine;
    int boots = 0;
    BootId boot_id{};
    std::vector<Received> received;
    std::vector<std::pair<Time, std::string>> presence;
    std::vector<GroupChangeFinished> group_changes;
    std::map<SendId, std::pair<SendFinished, Time>> finished;
  };

  bool run_until(Time end, const std::function<bool()>& done);
  void boot(std::size_t robot);
  void set_deadline(std::size_t robot, Time deadline);
  Time next_deadline();
  void serve_due();
  void serve(std::size_t robot);
  void take_events(std::size_t robot);
  void hash(const Frame& frame);

  Medium medium_;
  std::uint64_t seed_;
  Time now_{0};
  std::vector<Robot> robots_;
  /// When each engine wants to be polled, as far as known: what may have been touched since is due now. Asking each
  /// engine after each frame would cost more than all the rest.
  std::vector<Time> deadlines_;
  Time soonest_ = Time::min();  ///< none of them is earlier
  std::map<Medium::Node, std::size_t> by_node_;
  std::uint64_t polls_ = 0;
  std::uint64_t trace_hash_ = 0xcbf29ce484222325u;
};

}  // namespace adhoc_communication
