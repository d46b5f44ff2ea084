#include "node/engine_host.hpp"

#include <poll.h>
#include <sys/random.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

#include "adhoc_communication/compression.hpp"
#include "link/mac_address.hpp"
#include "link/steady_now.hpp"
#include "run_guarded.hpp"
#include "security/cipher.hpp"

namespace adhoc_communication {
namespace {

constexpr Time kTendingInterval = std::chrono::seconds(1);
const char* const kShutsDown = "the node is shutting down";

template <typename Value>
Value drawn_from_system() {
  Value value{};
  if (getrandom(&value, sizeof value, 0) != static_cast<ssize_t>(sizeof value)) {
    throw std::runtime_error("the system gives no random numbers");
  }
  return value;
}

/// Tells the first end only.
Waiter once(Waiter waiter) {
  const auto open = std::make_shared<Waiter>(std::move(waiter));
  return [open](const Outcome& end) {
    if (const Waiter told = std::exchange(*open, nullptr)) told(end);
  };
}

}  // namespace

EngineHost::EngineHost(const EngineOptions& options, std::unique_ptr<Link> link, ReceiveFilter filter,
                       HostCallbacks callbacks)
    : link_(std::move(link)),
      filter_(std::move(filter)),
      callbacks_(std::move(callbacks)),
      address_(link_->address()),
      mtu_(link_->mtu()),
      engine_time_(steady_now()),
      engine_(options, address_, drawn_from_system<BootId>(), drawn_from_system<std::uint64_t>(), engine_time_) {
  thread_ = std::thread([this] { run(); });
}

EngineHost::~EngineHost() { stop(); }

void EngineHost::stop() {
  commands_.close();
  if (thread_.joinable()) thread_.join();
}

void EngineHost::run() {
  const auto tell = [this](const std::string& text) {
    if (callbacks_.on_failure) callbacks_.on_failure(text);
  };
  run_guarded(
      "the engine", [this] { work(); }, tell);
  commands_.close();
  fail_all();
}

void EngineHost::work() {
  do {
    const bool link_has_something = wait_for_work();
    const Time woken = steady_now();
    if (link_has_something) receive_frames();
    engine_time_ = std::max(engine_time_, woken);
    commands_.run(engine_time_);
    transmit(engine_time_);
    report_events();
    report_records();
    tend_link(engine_time_);
  } while (!commands_.closed());
  commands_.run(engine_time_);  // those accepted before the end
}

/// True when the link has something.
bool EngineHost::wait_for_work() {
  const Time deadline = std::min(engine_.next_deadline(), next_tending_);
  const Time wait = std::max(deadline - steady_now(), Time::zero());
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(wait);
  const struct timespec timeout { static_cast<time_t>(seconds.count()), static_cast<long>((wait - seconds).count()) };
  struct pollfd sources[2] = {{commands_.descriptor(), POLLIN, 0}, {link_->descriptor(), POLLIN, 0}};
  ppoll(sources, 2, &timeout, nullptr);
  return sources[1].revents != 0;
}

/// The engine is told when each frame arrived, as it learns from the rhythm of frames how fast the radio is.
void EngineHost::receive_frames() {
  link_->receive([this](const Frame& frame, Time arrived) {
    engine_time_ = std::max(engine_time_, arrived);
    if (filter_.accepts(frame)) engine_.receive(frame, engine_time_);
  });
}

void EngineHost::transmit(Time now) {
  const std::vector<Frame> frames = engine_.poll(now);
  if (frames.empty()) return;
  link_->send(frames.data(), frames.size());
  engine_.handed_over(link_->keeps_frames());
}

void EngineHost::report_events() {
  while (auto event = engine_.next_event()) {
    std::visit([this](auto& value) { report(value); }, *event);
  }
  if (const auto address = filter_.next_unnamed_sender()) {
    callbacks_.on_warning("frames from " + to_text(*address) +
                          " are dropped: the channel model cannot tell which robot that is; name it in sim_robot_macs");
  }
}

void EngineHost::report_records() {
  std::vector<Record> records = engine_.take_records();
  if (!records.empty() && callbacks_.on_records) callbacks_.on_records(std::move(records), engine_time_);
}

void EngineHost::report(PacketReceived& packet) { callbacks_.on_packet(std::move(packet)); }

void EngineHost::report(const RobotAppeared& event) { callbacks_.on_robot_appeared(event.robot); }

void EngineHost::report(const RobotLost& event) { callbacks_.on_robot_lost(event.robot); }

void EngineHost::report(const NameTaken& event) {
  if (callbacks_.on_name_taken) callbacks_.on_name_taken(event.robot);
}

void EngineHost::report(const SendFinished& end) {
  const auto waiter = sends_.extract(end.id);
  if (waiter) waiter.mapped()({end.delivered, end.reason, end.superseded, end.missed});
}

void EngineHost::report(const GroupChangeFinished& end) {
  const auto [first, last] = group_changes_.equal_range({end.group, end.joined});
  for (auto waiter = first; waiter != last; ++waiter) waiter->second({end.succeeded, end.reason});
  group_changes_.erase(first, last);
}

void EngineHost::tend_link(Time now) {
  if (now < next_tending_) return;
  next_tending_ = now + kTendingInterval;
  link_->tend();
  if (link_->is_up() && (link_->address() != address_ || link_->mtu() != mtu_)) restart_engine(now);
  tell_link_state();
}

void EngineHost::tell_link_state() {
  const bool up = link_->is_up();
  const std::string trouble = link_->trouble();
  const bool is_told = up == link_was_up_ && (up || trouble.empty() || trouble == trouble_told_);
  if (is_told) return;
  link_was_up_ = up;
  trouble_told_ = trouble;
  const std::string why = trouble.empty() ? "" : ": " + trouble;
  callbacks_.on_warning(up ? "the interface is up again" : "the interface is down; waiting for its return" + why);
}

void EngineHost::restart_engine(Time now) {
  address_ = link_->address();
  mtu_ = link_->mtu();
  const std::string now_is = to_text(address_) + ", MTU " + std::to_string(mtu_);
  try {
    engine_.restart(address_, mtu_, drawn_from_system<BootId>(), drawn_from_system<std::uint64_t>(), now);
    callbacks_.on_warning("the interface has changed, so this robot begins anew as " + now_is);
  } catch (const std::invalid_argument& error) {
    callbacks_.on_warning("the interface has changed to " + now_is + ", which cannot be used: " + error.what());
  }
}

/// Nobody waits for an engine that has ended, be it by an exception: its thread is the last that could tell.
void EngineHost::fail_all() {
  commands_.fail();
  const auto fail = [](const auto& call) { run_guarded("", call, [](const std::string&) {}); };
  for (const auto& [id, waiter] : sends_) fail([&] { waiter({false, kShutsDown}); });
  for (const auto& [group, waiter] : group_changes_) fail([&] { waiter({false, kShutsDown}); });
  sends_.clear();
  group_changes_.clear();
}

Outcome EngineHost::wait_for(const std::function<void(Time, Waiter)>& begin) {
  const auto promise = std::make_shared<std::promise<Outcome>>();
  auto outcome = promise->get_future();
  const Waiter waiter = once([promise](const Outcome& end) { promise->set_value(end); });
  const auto fail = [waiter] { waiter({false, kShutsDown}); };
  if (!commands_.post({[&begin, waiter](Time now) { begin(now, waiter); }, fail})) return {false, kShutsDown};
  return outcome.get();
}

Outcome EngineHost::send(SendRequest request) {
  pack(request);
  return wait_for([this, &request](Time now, Waiter waiter) {
    sends_.emplace(engine_.send(std::move(request), now), std::move(waiter));
  });
}

void EngineHost::send(SendRequest request, Waiter waiter) {
  pack(request);
  const auto shared = std::make_shared<SendRequest>(std::move(request));  // commands can be copied
  const Waiter told = once(std::move(waiter));
  const auto run = [this, shared, told](Time now) { sends_.emplace(engine_.send(std::move(*shared), now), told); };
  const auto fail = [told] { told({false, kShutsDown}); };
  if (!commands_.post({run, fail})) fail();
}

Outcome EngineHost::broadcast(BroadcastRequest request) {
  pack(request);
  return wait_for([this, &request](Time now, Waiter waiter) {
    sends_.emplace(engine_.broadcast(std::move(request), now), std::move(waiter));
  });
}

Outcome EngineHost::join_group(const std::string& group) {
  return wait_for([this, &group](Time now, Waiter waiter) {
    group_changes_.emplace(std::pair(group, true), std::move(waiter));
    engine_.join_group(group, now);
  });
}

Outcome EngineHost::leave_group(const std::string& group) {
  return wait_for([this, &group](Time now, Waiter waiter) {
    group_changes_.emplace(std::pair(group, false), std::move(waiter));
    engine_.leave_group(group, now);
  });
}

template <typename Value>
Value EngineHost::ask(std::function<Value()> question) {
  const auto answer = std::make_shared<std::promise<Value>>();
  auto future = answer->get_future();
  const auto reply = [question = std::move(question), answer](Time) {
    try {
      answer->set_value(question());
    } catch (...) {
      answer->set_exception(std::current_exception());
    }
  };
  const auto fail = [answer] { answer->set_exception(std::make_exception_ptr(std::runtime_error(kShutsDown))); };
  if (!commands_.post({reply, fail})) throw std::runtime_error(kShutsDown);
  return future.get();
}

GroupState EngineHost::group_state(const std::string& group) {
  return ask<GroupState>([this, group] { return engine_.group_state(group); });
}

std::vector<std::string> EngineHost::neighbors() {
  return ask<std::vector<std::string>>([this] { return engine_.neighbors(); });
}

Snapshot EngineHost::look() const {
  Snapshot snapshot;
  snapshot.statistics = engine_.statistics();
  snapshot.robots = engine_.robots();
  snapshot.neighbors = engine_.neighbors();
  snapshot.links = engine_.links();
  snapshot.routes = engine_.routes();
  for (const RouteState& route : snapshot.routes) {
    for (const MacAddress& address : {route.destination, route.next_hop}) {
      if (const auto name = engine_.name_of(address)) snapshot.names[address] = *name;
    }
  }
  for (const std::string& group : engine_.groups()) snapshot.groups[group] = engine_.group_state(group);
  snapshot.queues = engine_.queues();
  snapshot.link_up = link_->is_up();
  snapshot.address = address_;
  snapshot.frames_missed = link_->frames_missed();
  snapshot.frames_not_sent = link_->frames_not_sent();
  snapshot.now = steady_now();
  return snapshot;
}

Snapshot EngineHost::snapshot() {
  return ask<Snapshot>([this] { return look(); });
}

void EngineHost::set_keys(std::vector<TeamKey> keys) {
  const auto shared = std::make_shared<std::vector<TeamKey>>(std::move(keys));  // questions can be copied
  ask<bool>([this, shared] {
    try {
      engine_.set_keys(*shared);
    } catch (...) {
      security::wipe(*shared);
      throw;
    }
    security::wipe(*shared);
    return true;
  });
}

}  // namespace adhoc_communication
