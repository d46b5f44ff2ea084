#include "simulation/team.hpp"

#include <algorithm>
#include <stdexcept>

#include "adhoc_communication/compression.hpp"

namespace adhoc_communication {

std::size_t Team::add(EngineOptions options, std::optional<double> x, double y) {
  const std::size_t robot = robots_.size();
  if (options.robot_name.empty()) options.robot_name = name(robot);
  Robot entry;
  entry.options = options;
  entry.node = medium_.add_node(options.robot_name, address(robot));
  if (x) medium_.set_position(entry.node, *x, y);
  by_node_[entry.node] = robot;
  robots_.push_back(std::move(entry));
  deadlines_.push_back(Time::min());
  boot(robot);
  return robot;
}

void Team::add_line(std::size_t count, const EngineOptions& options, double spacing) {
  for (std::size_t i = 0; i < count; ++i) add(options, static_cast<double>(i) * spacing);
}

MacAddress Team::address(std::size_t robot) {
  return {0x02, 0, 0, 0, static_cast<std::uint8_t>(robot >> 8), static_cast<std::uint8_t>(robot)};
}

void Team::boot(std::size_t robot) {
  Robot& entry = robots_[robot];
  ++entry.boots;
  Random random(seed_ * 1'000'003 + robot * 1009 + static_cast<std::uint64_t>(entry.boots));
  for (std::uint8_t& octet : entry.boot_id) octet = static_cast<std::uint8_t>(random.next());
  entry.engine = std::make_unique<Engine>(entry.options, address(robot), entry.boot_id, random.next(), now_);
  set_deadline(robot, Time::min());
}

void Team::kill(std::size_t robot) {
  medium_.set_up(robots_[robot].node, false, now_);
  robots_[robot].engine.reset();
  deadlines_[robot] = Time::max();
}

void Team::restart(std::size_t robot) {
  kill(robot);
  medium_.set_up(robots_[robot].node, true, now_);
  boot(robot);
}

void Team::set_keys(std::size_t robot, const std::vector<TeamKey>& keys) {
  Robot& entry = robots_[robot];
  entry.options.keys = keys;
  if (entry.engine) engine(robot).set_keys(keys);
}

SendId Team::send(std::size_t robot, const std::string& destination, Bytes payload, Priority priority,
                  const std::string& topic) {
  return send(robot, {destination, topic, 'A', std::move(payload), priority});
}

SendId Team::send(std::size_t robot, SendRequest request) {
  pack(request);
  return engine(robot).send(std::move(request), now_);
}

SendId Team::broadcast(std::size_t robot, BroadcastRequest request) {
  pack(request);
  return engine(robot).broadcast(std::move(request), now_);
}

const SendFinished* Team::finished(std::size_t robot, SendId id) const {
  const auto& finished = robots_.at(robot).finished;
  const auto found = finished.find(id);
  return found == finished.end() ? nullptr : &found->second.first;
}

bool Team::run_until(Time end, const std::function<bool()>& done) {
  int rounds_without_time = 0;
  for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
    if (alive(robot)) set_deadline(robot, Time::min());
  }
  for (;;) {
    serve_due();
    if (done()) return true;
    const Time next = std::min(next_deadline(), medium_.next_delivery().value_or(Time::max()));
    if (next > end) {
      now_ = end;
      return false;
    }
    rounds_without_time = next > now_ ? 0 : rounds_without_time + 1;
    if (rounds_without_time > 10'000) throw std::logic_error("an engine asks for polls without end");
    now_ = std::max(now_, next);
    for (const Medium::Delivery& delivery : medium_.deliveries(now_)) {
      if (on_frame) on_frame(delivery.node, *delivery.frame);
      const auto robot = by_node_.find(delivery.node);
      if (robot == by_node_.end() || !robots_[robot->second].engine) continue;
      // An interface drops what is longer than it takes.
      if (delivery.frame->bytes.size() > static_cast<std::size_t>(robots_[robot->second].options.mtu)) continue;
      engine(robot->second).receive(*delivery.frame, now_);
      if (after_step) after_step(robot->second);
      serve(robot->second);
    }
  }
}

void Team::set_deadline(std::size_t robot, Time deadline) {
  deadlines_.at(robot) = deadline;
  soonest_ = std::min(soonest_, deadline);
}

Time Team::next_deadline() {
  soonest_ = Time::max();
  for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
    if (deadlines_[robot] == Time::min()) deadlines_[robot] = robots_[robot].engine->next_deadline();
    soonest_ = std::min(soonest_, deadlines_[robot]);
  }
  return soonest_;
}

void Team::serve_due() {
  if (soonest_ > now_) return;
  for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
    if (deadlines_[robot] <= now_) serve(robot);
  }
}

void Team::serve(std::size_t robot) {
  Robot& entry = robots_[robot];
  if (!entry.engine) return;
  set_deadline(robot, entry.engine->next_deadline());
  if (deadlines_[robot] > now_) return take_events(robot);
  ++polls_;
  for (Frame& frame : entry.engine->poll(now_)) {
    hash(frame);
    if (on_transmission) on_transmission(robot, frame);
    medium_.transmit(entry.node, std::move(frame), now_);
  }
  entry.engine->handed_over(medium_.keeps_frames(entry.node));
  set_deadline(robot, entry.engine->next_deadline());
  take_events(robot);
  if (after_step) after_step(robot);
}

void Team::take_events(std::size_t robot) {
  Robot& entry = robots_[robot];
  while (std::optional<Event> event = entry.engine->next_event()) {
    if (auto* packet = std::get_if<PacketReceived>(&*event); packet != nullptr && !unpack(*packet)) continue;
    if (on_event) on_event(robot, *event);
    if (!remembers) continue;
    if (auto* received = std::get_if<PacketReceived>(&*event)) entry.received.push_back({std::move(*received), now_});
    if (auto* finished = std::get_if<SendFinished>(&*event)) entry.finished[finished->id] = {*finished, now_};
    if (auto* appeared = std::get_if<RobotAppeared>(&*event)) entry.presence.emplace_back(now_, "+" + appeared->robot);
    if (auto* lost = std::get_if<RobotLost>(&*event)) entry.presence.emplace_back(now_, "-" + lost->robot);
    if (auto* taken = std::get_if<NameTaken>(&*event)) entry.presence.emplace_back(now_, "=" + taken->robot);
    if (auto* change = std::get_if<GroupChangeFinished>(&*event)) entry.group_changes.push_back(*change);
  }
}

void Team::hash(const Frame& frame) {
  const auto add = [this](std::uint8_t octet) { trace_hash_ = (trace_hash_ ^ octet) * 0x100000001b3u; };
  for (int shift = 0; shift < 64; shift += 8) add(static_cast<std::uint8_t>(now_.count() >> shift));
  for (const std::uint8_t octet : frame.bytes) add(octet);
}

}  // namespace adhoc_communication
