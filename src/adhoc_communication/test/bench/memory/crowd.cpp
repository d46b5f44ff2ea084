#include "crowd.hpp"

#include <algorithm>

#include "wire/frame_header.hpp"

namespace adhoc_communication::bench {

Crowd::Crowd(const std::vector<TeamKey>& keys)
    : keys_(keys), middle_(options(kNeighbors), middle(), Time(0)), neighbors_(kNeighbors) {
  for (std::size_t neighbor = 0; neighbor < kNeighbors; ++neighbor) {
    neighbors_[neighbor].sends_at = std::chrono::seconds(10) + random_.delay(kInterval);
    boot(neighbor);
  }
}

EngineOptions Crowd::options(std::size_t robot) const {
  EngineOptions options;
  options.robot_name = name(robot);
  options.keys = keys_;
  options.join_groups_automatically = false;
  return options;
}

void Crowd::boot(std::size_t neighbor) {
  Neighbor& entry = neighbors_[neighbor];
  BootId boot_id{};
  for (std::uint8_t& octet : boot_id) octet = static_cast<std::uint8_t>(random_.next());
  entry.engine = std::make_unique<Engine>(options(neighbor), address(neighbor), boot_id, random_.next(), now_);
  entry.deadline = now_;
}

void Crowd::restart(std::size_t neighbor) { boot(neighbor); }

void Crowd::run_for(Time duration) {
  const Time end = now_ + duration;
  while (next() <= end) {
    now_ = std::max(now_, next());
    land();
    for (std::size_t neighbor = 0; neighbor < kNeighbors; ++neighbor) {
      if (neighbors_[neighbor].sends_at <= now_) send_something(neighbor);
      if (neighbors_[neighbor].deadline <= now_) serve(neighbor);
    }
    if (middle_deadline_ <= now_) step_middle({});
  }
  now_ = end;
}

Time Crowd::next() const {
  Time next = flights_.empty() ? middle_deadline_ : std::min(middle_deadline_, flights_.front().arrives);
  for (const Neighbor& neighbor : neighbors_) next = std::min({next, neighbor.deadline, neighbor.sends_at});
  return next;
}

/// Every other packet is for the robot in the middle, every tenth is large.
void Crowd::send_something(std::size_t neighbor) {
  Neighbor& sender = neighbors_[neighbor];
  sender.sends_at += kInterval;
  const std::size_t other = random_.next() % 2 == 0 ? kNeighbors : random_.next() % kNeighbors;
  Bytes payload(random_.next() % 10 == 0 ? 20'000 : 200);
  for (std::uint8_t& octet : payload) octet = static_cast<std::uint8_t>(random_.next());
  sender.engine->send({name(other), "topic", 'A', std::move(payload), Priority::kNormal}, now_);
  sender.deadline = now_;
}

void Crowd::serve(std::size_t neighbor) {
  Neighbor& entry = neighbors_[neighbor];
  for (Frame& frame : entry.engine->poll(now_)) {
    if (recorded_.size() == kMostRecorded) recorded_.pop_front();
    recorded_.push_back(frame);
    flights_.push_back({now_ + kDelay, kNeighbors, std::move(frame)});
  }
  while (const auto event = entry.engine->next_event()) {
    if (std::holds_alternative<PacketReceived>(*event)) ++delivered_;
  }
  entry.deadline = entry.engine->next_deadline();
}

void Crowd::land() {
  std::vector<Frame> for_middle;
  while (!flights_.empty() && flights_.front().arrives <= now_) {
    Flight flight = std::move(flights_.front());
    flights_.pop_front();
    if (flight.to == kNeighbors) {
      for_middle.push_back(std::move(flight.frame));
    } else {
      neighbors_[flight.to].engine->receive(flight.frame, now_);
      neighbors_[flight.to].deadline = now_;
    }
  }
  if (!for_middle.empty()) step_middle(for_middle);
}

void Crowd::step_middle(const std::vector<Frame>& frames) {
  SeparateEngine::Answer answer = middle_.step(frames, now_);
  middle_deadline_ = answer.next_deadline;
  resident_ = answer.resident;
  peak_ = answer.peak;
  for (const Frame& frame : answer.frames) {
    for (std::size_t neighbor = 0; neighbor < kNeighbors; ++neighbor) {
      const bool is_for_it = frame.destination == wire::kEverybody || frame.destination == address(neighbor);
      if (is_for_it) flights_.push_back({now_ + kDelay, neighbor, frame});
    }
  }
}

}  // namespace adhoc_communication::bench
